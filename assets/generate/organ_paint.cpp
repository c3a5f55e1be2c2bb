#include "assets/generate/organ_paint.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "assets/generate/noise.h"
#include "engine/core/texel_raster.h"

namespace viscera::assets {
namespace {

// Texels beyond a chart's border that filtering may reach.
constexpr int painted_gutter = 4;

double noise(const glm::dvec3& p, double feature_mm, int octaves, std::uint32_t seed) {
    return fractal_noise(p / feature_mm, octaves, seed);
}

/// Distance to the nearest and second nearest of points strewn one per cell, in cells (Worley 1996).
glm::dvec2 cells(const glm::dvec3& p, std::uint32_t seed) {
    const glm::dvec3 base = glm::floor(p);
    glm::dvec2 nearest(std::numeric_limits<double>::max());
    for (int z = -1; z <= 1; ++z) {
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x) {
                const glm::dvec3 cell = base + glm::dvec3(x, y, z);
                std::uint32_t h = seed;
                for (int c = 0; c < 3; ++c) {
                    h = (h ^ static_cast<std::uint32_t>(static_cast<std::int64_t>(cell[c]))) * 0x85ebca6bU;
                    h ^= h >> 15U;
                    h *= 0xc2b2ae35U;
                    h ^= h >> 13U;
                }
                const glm::dvec3 point =
                    cell + glm::dvec3(h & 1023U, (h >> 10U) & 1023U, (h >> 20U) & 1023U) / 1023.0;
                const double d = glm::distance(p, point);
                if (d < nearest.x) {
                    nearest = {d, nearest.x};
                } else {
                    nearest.y = std::min(nearest.y, d);
                }
            }
        }
    }
    return nearest;
}

/// 1 along the zero surfaces of a warped noise, which cut a surface in branching lines; 0 beside them.
double vessels(const glm::dvec3& p, double feature_mm, double width, std::uint32_t seed) {
    const glm::dvec3 q = p / feature_mm + 0.35 * fractal_warp(p / feature_mm, 2, seed + 17U);
    const double line = std::abs(gradient_noise(q, seed)) / width;
    return std::clamp(1.0 - line, 0.0, 1.0);
}

glm::vec4 encode(const glm::dvec2& slopes) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(-slopes, 1.0));
    return {glm::vec3((n * 127.0 + 128.0) / 255.0), 1.0F};
}

/// Slopes of a relief along u and v, by differences in the surface.
glm::vec4 normal_of(const PaintPoint& point, const std::function<double(const glm::dvec3&)>& relief) {
    constexpr double step = 0.12;
    const double here = relief(point.place);
    return encode({(relief(point.place + step * point.along_u) - here) / step,
                   (relief(point.place + step * point.along_v) - here) / step});
}

double smooth(double low, double high, double x) {
    const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/// Distance to a line from a to b.
double line_distance(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const double t = std::clamp(glm::dot(p - a, b - a) / glm::dot(b - a, b - a), 0.0, 1.0);
    return glm::distance(p, a + t * (b - a));
}

}  // namespace

ColourImage paint_atlas(const MeshData& mesh, int size,
                        const std::function<glm::vec4(const PaintPoint&)>& paint) {
    struct Nearest {
        double outside = std::numeric_limits<double>::max();
        std::size_t triangle = 0;
        double b1 = 0.0;
        double b2 = 0.0;
    };
    std::vector<Nearest> nearest(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        std::array<glm::dvec2, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) {
            corner[k] = static_cast<double>(size) * glm::dvec2(mesh.uvs[mesh.indices[3 * t + k]]);
        }
        const glm::dvec2 e1 = corner[1] - corner[0];
        const glm::dvec2 e2 = corner[2] - corner[0];
        const double area = cross2(e1, e2);
        const glm::dvec2 low = glm::min(corner[0], glm::min(corner[1], corner[2])) - double{painted_gutter};
        const glm::dvec2 high = glm::max(corner[0], glm::max(corner[1], corner[2])) + double{painted_gutter};
        for (int y = std::max(0, static_cast<int>(low.y)); area != 0.0 && y < std::min<double>(size, high.y);
             ++y) {
            for (int x = std::max(0, static_cast<int>(low.x)); x < std::min<double>(size, high.x); ++x) {
                const glm::dvec2 q = glm::dvec2(x + 0.5, y + 0.5) - corner[0];
                const double b1 = cross2(q, e2) / area;
                const double b2 = cross2(e1, q) / area;
                // How far beyond an edge [texels]: weight times the height over that edge.
                const double h = std::abs(area);
                const double outside = std::max({-b1 * h / glm::length(e2), -b2 * h / glm::length(e1),
                                                 -(1.0 - b1 - b2) * h / glm::length(e2 - e1), 0.0});
                Nearest& texel = nearest[static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
                                         static_cast<std::size_t>(x)];
                if (outside <= painted_gutter && outside < texel.outside) {
                    texel = {outside, t, b1, b2};
                }
            }
        }
    }
    ColourImage image(size, size, glm::vec4(0.0F));
    glm::dvec4 sum(0.0);
    double count = 0.0;
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const Nearest& texel = nearest[i];
        if (texel.outside > painted_gutter) {
            continue;
        }
        const auto vertex = [&](std::size_t k) { return mesh.indices[3 * texel.triangle + k]; };
        const glm::dvec3 p0(mesh.positions[vertex(0)]);
        const glm::dvec3 p1 = glm::dvec3(mesh.positions[vertex(1)]) - p0;
        const glm::dvec3 p2 = glm::dvec3(mesh.positions[vertex(2)]) - p0;
        const glm::dvec2 uv0(mesh.uvs[vertex(0)]);
        const glm::dvec2 d1 = glm::dvec2(mesh.uvs[vertex(1)]) - uv0;
        const glm::dvec2 d2 = glm::dvec2(mesh.uvs[vertex(2)]) - uv0;
        const double det = cross2(d1, d2);
        const glm::dvec3 n0(mesh.normals[vertex(0)]);
        PaintPoint point;
        point.place = p0 + texel.b1 * p1 + texel.b2 * p2;
        point.normal = glm::normalize(n0 + texel.b1 * (glm::dvec3(mesh.normals[vertex(1)]) - n0) +
                                      texel.b2 * (glm::dvec3(mesh.normals[vertex(2)]) - n0));
        point.along_u = glm::normalize((p1 * d2.y - p2 * d1.y) / det);
        point.along_v = glm::normalize((p2 * d1.x - p1 * d2.x) / det);
        image.pixels[i] = paint(point);
        sum += glm::dvec4(image.pixels[i]);
        count += 1.0;
    }
    // Alpha stays 0 where nothing is, in case it means something.
    const glm::vec4 mean(sum / std::max(count, 1.0));
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        if (nearest[i].outside > painted_gutter) {
            image.pixels[i] = mean;
        }
    }
    return image;
}

glm::vec4 OrganPaint::colour(const PaintPoint& point) const {
    const glm::dvec3& p = point.place;
    const OrganTissue tissue = field_.tissue(p);
    const double mottle = noise(p, 14.0, 4, seed_);
    const double fine = noise(p, 1.6, 2, seed_ + 1U);
    glm::dvec3 sum(0.0);
    if (tissue.liver > 0.0) {
        // Lobules: pale middles, dark borders; small vessels under the capsule.
        const glm::dvec2 lobule = cells(p / 1.5, seed_ + 2U);
        const double border = smooth(0.0, 0.35, lobule.y - lobule.x);
        glm::dvec3 c = glm::mix(glm::dvec3(0.375, 0.108, 0.078), glm::dvec3(0.425, 0.135, 0.096), border);
        c *= 1.0 + 0.16 * mottle + 0.06 * fine;
        c = glm::mix(c, glm::dvec3(0.30, 0.05, 0.06), 0.5 * vessels(p, 21.0, 0.045, seed_ + 3U));
        c = glm::mix(c, glm::dvec3(0.60, 0.33, 0.24),
                     0.35 * smooth(0.35, 0.8, noise(p, 38.0, 2, seed_ + 4U)));
        sum += tissue.liver * c;
    }
    if (tissue.gallbladder > 0.0) {
        glm::dvec3 c =
            glm::mix(glm::dvec3(0.44, 0.45, 0.30), glm::dvec3(0.60, 0.53, 0.42), 0.5 + 0.6 * mottle);
        c *= 1.0 + 0.05 * fine;
        c = glm::mix(c, glm::dvec3(0.58, 0.17, 0.14), 0.7 * vessels(p, 13.0, 0.06, seed_ + 5U));
        c = glm::mix(c, glm::dvec3(0.62, 0.22, 0.18), 0.5 * vessels(p, 4.5, 0.05, seed_ + 6U));
        sum += tissue.gallbladder * c;
    }
    if (tissue.fat > 0.0) {
        const glm::dvec2 lobe = cells(p / 4.2, seed_ + 7U);
        const double groove = smooth(0.0, 0.3, lobe.y - lobe.x);
        glm::dvec3 c = glm::mix(glm::dvec3(0.79, 0.54, 0.26), glm::dvec3(0.88, 0.69, 0.36), groove);
        c *= 1.0 + 0.13 * mottle + 0.04 * fine;
        c = glm::mix(c, glm::dvec3(0.64, 0.16, 0.12), 0.75 * vessels(p, 24.0, 0.05, seed_ + 8U));
        c = glm::mix(c, glm::dvec3(0.72, 0.27, 0.18), 0.5 * vessels(p, 8.0, 0.05, seed_ + 9U));
        sum += tissue.fat * c;
    }
    // Blood gathers in the bed's fold.
    sum *= 1.0 - 0.35 * (1.0 - smooth(0.5, 3.5, field_.bed_distance(p)));
    return {glm::vec3(glm::clamp(sum, 0.0, 1.0)), 1.0F};
}

double OrganPaint::relief(const glm::dvec3& p, const OrganTissue& tissue) const {
    double height = 0.0;
    if (tissue.liver > 0.0) {
        const glm::dvec2 lobule = cells(p / 1.5, seed_ + 2U);
        height += tissue.liver *
                  (0.012 * smooth(0.0, 0.5, lobule.y - lobule.x) + 0.10 * noise(p, 6.0, 2, seed_ + 10U));
    }
    if (tissue.gallbladder > 0.0) {
        height += tissue.gallbladder *
                  (0.10 * noise(p, 3.0, 2, seed_ + 11U) + 0.12 * vessels(p, 13.0, 0.12, seed_ + 5U));
    }
    if (tissue.fat > 0.0) {
        const glm::dvec2 lobe = cells(p / 4.2, seed_ + 7U);
        height +=
            tissue.fat * (0.30 * smooth(0.0, 0.8, lobe.y - lobe.x) + 0.20 * noise(p, 2.0, 2, seed_ + 12U) +
                          0.15 * vessels(p, 24.0, 0.1, seed_ + 8U));
    }
    return height;
}

glm::vec4 OrganPaint::normal(const PaintPoint& point) const {
    const OrganTissue tissue = field_.tissue(point.place);
    return normal_of(point, [&](const glm::dvec3& p) { return relief(p, tissue); });
}

glm::vec4 OrganPaint::hint(const PaintPoint& point) const {
    constexpr double half_width_mm = 2.6;
    const double d = field_.bed_distance(point.place);
    return {0.15F, 0.85F, 0.45F, static_cast<float>(1.0 - smooth(0.7 * half_width_mm, half_width_mm, d))};
}

OrganPaint::OrganPaint(const OrganField& field, std::uint64_t seed)
    : field_(field),
      seed_(static_cast<std::uint32_t>(seed * 131U + 5U)),
      cut_line_{field.onto_surface({-22.0, -32.0, -26.0}), field.onto_surface({-56.0, -30.0, -26.0})},
      cut_aside_(glm::normalize(
          glm::cross(cut_line_[1] - cut_line_[0], field.normal(0.5 * (cut_line_[0] + cut_line_[1]))))) {}

glm::vec4 OrganPaint::cut(const PaintPoint& point) const {
    const auto& [a, b] = cut_line_;
    const glm::dvec3& p = point.place;
    // A chord through the body: the surface bulges over it by a few millimetres.
    constexpr double bulge_mm = 12.0;
    if (line_distance(p, a, b) > bulge_mm) {
        return {0.40F, 0.055F, 0.045F, 0.0F};
    }
    const double wobble = 0.5 * noise(p, 5.0, 2, seed_ + 13U);
    const double t = glm::dot(p - a, b - a) / glm::dot(b - a, b - a);
    const double width = 1.3 * std::sqrt(std::clamp(4.0 * t * (1.0 - t), 0.0, 1.0));
    const bool inside = std::abs(glm::dot(p - a, cut_aside_) + wobble) < width;
    const double grain = 0.5 + 0.5 * noise(p, 0.9, 3, seed_ + 14U);
    const glm::dvec3 c = glm::mix(glm::dvec3(0.25, 0.015, 0.015), glm::dvec3(0.55, 0.095, 0.075), grain);
    return {glm::vec3(glm::clamp(c, 0.0, 1.0)), inside ? 1.0F : 0.0F};
}

glm::vec4 abdomen_colour(const PaintPoint& point, std::uint64_t seed) {
    const auto s = static_cast<std::uint32_t>(seed * 57U + 3U);
    const glm::dvec3& p = point.place;
    const double mottle = noise(p, 40.0, 4, s);
    glm::dvec3 c = glm::mix(glm::dvec3(0.50, 0.20, 0.16), glm::dvec3(0.74, 0.46, 0.38), 0.5 + 0.55 * mottle);
    // Muscle fibres shimmer through.
    const glm::dvec3 fibres(p.x / 26.0, p.y / 26.0, (p.z + 0.6 * p.x) / 2.6);
    c *= 1.0 + 0.10 * fractal_noise(fibres, 3, s + 1U);
    c = glm::mix(c, glm::dvec3(0.80, 0.62, 0.36), 0.6 * smooth(0.25, 0.7, noise(p, 55.0, 3, s + 2U)));
    c = glm::mix(c, glm::dvec3(0.50, 0.10, 0.12), 0.65 * vessels(p, 60.0, 0.03, s + 3U));
    c = glm::mix(c, glm::dvec3(0.60, 0.18, 0.16), 0.45 * vessels(p, 19.0, 0.035, s + 4U));
    return {glm::vec3(glm::clamp(c, 0.0, 1.0)), 1.0F};
}

glm::vec4 abdomen_normal(const PaintPoint& point, std::uint64_t seed) {
    const auto s = static_cast<std::uint32_t>(seed * 57U + 3U);
    return normal_of(point, [&](const glm::dvec3& p) {
        return 0.5 * noise(p, 9.0, 3, s + 5U) + 0.25 * vessels(p, 60.0, 0.07, s + 3U);
    });
}

}  // namespace viscera::assets

#include "tests/reference/organ.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "tests/reference/raster.h"

namespace viscera::reference {
namespace {

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : glm::dvec3(0.0);
}

glm::dvec3 mixed(const glm::dvec3& a, const glm::dvec3& b, double share) {
    return a * (1.0 - share) + b * share;
}

/// One triangle's attributes at any pixel, within it or not.
class Plane {
  public:
    Plane(const Organ& organ, const std::array<std::uint32_t, 3>& vertices, int width, int height)
        : organ_(organ), vertices_(vertices) {
        std::array<glm::dvec3, 3> rows;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec4 clip =
                organ.projection * organ.view * glm::dvec4(organ.positions[vertices[i]], 1.0);
            rows[i] = {0.5 * (clip.x + clip.w) * width, 0.5 * (clip.y + clip.w) * height, clip.w};
        }
        for (std::size_t i = 0; i < 3; ++i) {
            planes_[i] = glm::cross(rows[(i + 1) % 3], rows[(i + 2) % 3]);
        }
        facing_ = glm::dot(rows[0], planes_[0]);
    }
    [[nodiscard]] bool front() const { return facing_ > 0.0; }
    template <class Values>
    [[nodiscard]] auto at(const Values& values, int x, int y) const {
        const glm::dvec3 p(x + 0.5, y + 0.5, 1.0);
        const glm::dvec3 raw(glm::dot(planes_[0], p), glm::dot(planes_[1], p), glm::dot(planes_[2], p));
        const glm::dvec3 w = raw / (raw.x + raw.y + raw.z);
        return values[vertices_[0]] * w.x + values[vertices_[1]] * w.y + values[vertices_[2]] * w.z;
    }
    template <class Values>
    [[nodiscard]] auto along_x(const Values& values, int x, int y) const {
        const int first = x & ~1;
        return at(values, first + 1, y) - at(values, first, y);
    }
    template <class Values>
    [[nodiscard]] auto along_y(const Values& values, int x, int y) const {
        const int first = y & ~1;
        return at(values, x, first + 1) - at(values, x, first);
    }

  private:
    const Organ& organ_;
    std::array<std::uint32_t, 3> vertices_;
    std::array<glm::dvec3, 3> planes_;
    double facing_ = 0.0;
};

struct Shaded {
    glm::dvec4 colour{0.0};  ///< blended: multiplied by cover
    double cover = 1.0;
};

glm::dvec3 sample3(const OrganMap& map, const glm::dvec2& uv) {
    return {map.at(uv, 0), map.at(uv, 1), map.at(uv, 2)};
}

/// Wrapped bilinear lookup, uv in pictures.
double repeated(const Buffer& picture, const glm::dvec2& uv, int channel) {
    const double u = uv.x * picture.width - 0.5;
    const double v = uv.y * picture.height - 0.5;
    const double i = std::floor(u);
    const double j = std::floor(v);
    const auto wrapped = [](double k, int n) { return static_cast<int>(k - n * std::floor(k / n)); };
    const auto texel = [&](double x, double y) {
        return picture.at(wrapped(x, picture.width), wrapped(y, picture.height), channel);
    };
    const double a = u - i;
    const double b = v - j;
    return (1.0 - a) * (1.0 - b) * texel(i, j) + a * (1.0 - b) * texel(i + 1.0, j) +
           (1.0 - a) * b * texel(i, j + 1.0) + a * b * texel(i + 1.0, j + 1.0);
}

/// From the far to the near end of one ray, in the eye's axes.
glm::dvec3 against_parallel_rays(const Organ& organ) {
    const glm::dmat4 from_clip = glm::inverse(organ.projection);
    return glm::normalize(glm::dvec3(from_clip * glm::dvec4(0.0, 0.0, -1.0, 1.0)) -
                          glm::dvec3(from_clip * glm::dvec4(0.0, 0.0, 1.0, 1.0)));
}

Shaded shade(const Organ& organ, const Plane& plane, int x, int y) {
    const auto in_eye = [&](const glm::dvec3& p) { return glm::dvec3(organ.view * glm::dvec4(p, 1.0)); };
    const glm::dvec3 world = plane.at(organ.positions, x, y);
    const glm::dvec3 place = in_eye(world);
    const glm::dvec2 uv = plane.at(organ.uvs, x, y);
    const double side = plane.front() ? 1.0 : -1.0;
    const glm::dvec3 smooth = unit_or_zero(glm::dmat3(organ.view) * plane.at(organ.normals, x, y));
    glm::dvec3 normal = side * smooth;
    const glm::dvec3 eye = organ.orthographic ? against_parallel_rays(organ) : unit_or_zero(-place);

    glm::dvec3 colour = organ.colour;
    double alpha = 1.0;
    const glm::dvec2 ux = plane.along_x(organ.uvs, x, y);
    const glm::dvec2 uy = plane.along_y(organ.uvs, x, y);
    const auto seen = [&](const OrganMap& map, int channel) {
        return map.at(uv, channel, ux, uy, organ.nearer);
    };
    const auto seen3 = [&](const OrganMap& map) {
        return glm::dvec3(seen(map, 0), seen(map, 1), seen(map, 2));
    };
    if (!organ.diffuse.empty()) {
        colour *= seen3(organ.diffuse);
        alpha = seen(organ.diffuse, 3);
    }
    bool cut = false;
    if (!organ.cut_map.empty()) {
        cut = organ.cut.empty() ? organ.cut_map.at(uv, 3) > 0.0 : plane.at(organ.cut, x, y) > 0.0;
        const glm::dvec3 flesh = organ.cut.empty() ? sample3(organ.cut_map, uv) : seen3(organ.cut_map);
        colour = cut ? flesh : colour;
    }
    double bruise = 0.0;
    for (const glm::dvec4& spot : organ.spots) {
        const glm::dvec3 here = organ.spots_in_uv ? glm::dvec3(uv, 0.0) : world;
        bruise = std::max(bruise, 1.0 - glm::distance(here, glm::dvec3(spot)) / spot.w);
    }
    colour = mixed(colour, organ.hematoma_colour, organ.hematoma_strength * bruise);
    Burn burn;
    if (!organ.energy.empty()) {
        burn = burn_of(organ.energy.at(uv, 0), organ.thesis_burn);
        const glm::dvec3 coagulated =
            mixed(colour, organ.coagulation_colour, organ.saturation) * organ.brightness;
        colour = mixed(mixed(colour, coagulated, burn.coagulated), glm::dvec3(0.0), burn.charred);
    }
    double wet = 0.0;
    if (!organ.blood.empty() && !cut) {
        wet = std::clamp(organ.blood.at(uv, 3), 0.0, 1.0);
        colour *= sample3(organ.blood, uv);
    }
    if (!organ.hint.empty() && !cut) {
        colour = mixed(colour, seen3(organ.hint), organ.hint_share * seen(organ.hint, 3));
    }

    const glm::dvec3 px = glm::dmat3(organ.view) * plane.along_x(organ.positions, x, y);
    const glm::dvec3 py = glm::dmat3(organ.view) * plane.along_y(organ.positions, x, y);
    // Slopes [mm/mm] along dP/du and dP/dv as rises per unit of u and of v.
    const double det = ux.x * uy.y - ux.y * uy.x;
    const glm::dvec2 mm_per_unit(glm::length(px * uy.y - py * ux.y) / std::abs(det),
                                 glm::length(py * ux.x - px * uy.x) / std::abs(det));
    const auto rise = [&](const glm::dvec2& slopes) {
        return side * glm::dvec2(glm::dot(slopes, ux), glm::dot(slopes, uy));
    };
    if (!organ.slopes.empty()) {
        const double strength = organ.bump * (1.0 + organ.bump_gain * burn.coagulated) * (1.0 - 0.5 * wet);
        normal =
            bumped(normal, px, py,
                   rise(strength * mm_per_unit * glm::dvec2(seen(organ.slopes, 0), seen(organ.slopes, 1))));
    }
    if (!organ.blood_normal.empty()) {
        const glm::dvec3 n = sample3(organ.blood_normal, uv);
        const glm::dvec2 slopes = n.z > 1e-3 ? -glm::dvec2(n) / n.z : glm::dvec2(0.0);
        normal = bumped(normal, px, py, rise(organ.blood_bump * mm_per_unit * slopes));
    }
    if (!organ.blood_height.empty()) {
        const glm::dvec2 texels(organ.blood_height.picture.width, organ.blood_height.picture.height);
        const auto difference = [&](const glm::dvec2& step) {
            return organ.blood_height.at(uv + step, 0) - organ.blood_height.at(uv - step, 0);
        };
        const glm::dvec2 slopes =
            0.5 * texels * glm::dvec2(difference({1.0 / texels.x, 0.0}), difference({0.0, 1.0 / texels.y}));
        normal = bumped(normal, px, py, rise(organ.blood_bump * slopes));
    }

    glm::dvec3 scattered(0.0);
    glm::dvec3 added(0.0);
    const double gloss = std::max(0.05, std::pow(1.0 - burn.coagulated, 2.0));
    for (const OrganLight& light : organ.lights) {
        const glm::dvec3 way = light.infinite ? light.place : light.place - place;
        const double distance = glm::length(way);
        const glm::dvec3 l = unit_or_zero(way);
        double reach = 1.0;
        if (!light.infinite && light.falloff_mm > 0.0) {
            reach = std::clamp(1.0 - distance * distance / (light.falloff_mm * light.falloff_mm), 0.0, 1.0);
        }
        reach *= std::pow(std::max(l.z, 0.0), light.angular);
        const glm::dvec3 arrives = light.colour * reach * reach;
        const double facing = std::max(glm::dot(normal, l), 0.0);
        const double mirrored =
            std::pow(std::max(glm::dot(normal, unit_or_zero(l + eye)), 0.0), organ.shininess) *
            (organ.shininess + 6.0) / (8.0 * 3.14) * facing;
        scattered += arrives * (organ.ambient + organ.diffuse_share * facing);
        added += arrives * organ.specular_colour * (organ.specular * gloss * mirrored);
        if (!light.infinite && distance < light.glow_mm) {
            added +=
                light.colour * std::min(light.glow_per_mm2 * std::pow(distance - light.glow_mm, 2.0), 1.0);
        }
    }
    const double stored = organ.focus ? stored_blurriness(*organ.focus, -place.z) : 0.5;
    if (!organ.blended) {
        return {glm::dvec4(colour * scattered + added, stored), 1.0};
    }
    const double way = 1.0 / std::max(std::abs(glm::dot(smooth, eye)), 1e-3);
    const double there = std::clamp(alpha, 0.0, 1.0);
    const double cover = there * (1.0 - std::pow(1.0 - organ.opacity, way));
    return {glm::dvec4(colour * scattered * cover + added * there, stored * cover), cover};
}

/// Triangles as they are drawn: as they come, or from back to front.
std::vector<std::uint32_t> drawing_order(const Organ& organ) {
    std::vector<std::uint32_t> triangles(organ.indices.size() / 3);
    std::iota(triangles.begin(), triangles.end(), 0U);
    if (organ.blended) {
        const auto height = [&](std::uint32_t t) {
            double sum = 0.0;
            for (std::size_t k = 0; k < 3; ++k) {
                sum += (organ.view * glm::dvec4(organ.positions[organ.indices[3 * t + k]], 1.0)).z;
            }
            return sum;
        };
        std::ranges::stable_sort(triangles, {}, height);
    }
    std::vector<std::uint32_t> indices;
    for (const std::uint32_t t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            indices.push_back(organ.indices[3 * t + k]);
        }
    }
    return indices;
}

}  // namespace

double OrganMap::at(const glm::dvec2& uv, int channel) const {
    if (!repeats) {
        return sample_linear(picture, repeat * uv, channel);
    }
    return repeated(picture, repeat * uv, channel);
}

void OrganMap::make_smaller() {
    smaller.clear();
    const Buffer* from = &picture;
    while (from->width > 1) {
        Buffer half(from->width / 2, from->height / 2, from->channels);
        for (int y = 0; y < half.height; ++y) {
            for (int x = 0; x < half.width; ++x) {
                for (int c = 0; c < half.channels; ++c) {
                    half.at(x, y, c) =
                        0.25 * (from->at(2 * x, 2 * y, c) + from->at(2 * x + 1, 2 * y, c) +
                                from->at(2 * x, 2 * y + 1, c) + from->at(2 * x + 1, 2 * y + 1, c));
                }
            }
        }
        smaller.push_back(std::move(half));
        from = &smaller.back();
    }
}

double OrganMap::at(const glm::dvec2& uv, int channel, const glm::dvec2& ux, const glm::dvec2& uy,
                    double nearer) const {
    const glm::dvec2 texels(picture.width, picture.height);
    const double longer = std::max(glm::length(repeat * texels * ux), glm::length(repeat * texels * uy));
    const double level = std::log2(std::max(longer, 1e-9));
    if (smaller.empty() || level <= 0.0) {
        return at(uv, channel);
    }
    const auto whole = static_cast<std::size_t>(std::min(level, static_cast<double>(smaller.size())));
    const double share = std::clamp(level - static_cast<double>(whole) + nearer, 0.0, 1.0);
    const Buffer& large = whole == 0 ? picture : smaller[whole - 1];
    const Buffer& small = whole == smaller.size() ? large : smaller[whole];
    return (1.0 - share) * repeated(large, repeat * uv, channel) +
           share * repeated(small, repeat * uv, channel);
}

Burn burn_of(double energy, bool thesis_curve) {
    const double alpha = 2.0 * (1.0 - std::pow(2.0, -std::abs(energy)));
    const auto logistic = [](double a) { return 1.0 / (1.0 + std::exp(-40.0 * (a - 0.1))); };
    const double burn = logistic(std::min(alpha, 1.0));
    return {thesis_curve ? burn : burn - logistic(0.0), std::clamp(alpha - 0.85, 0.0, 1.0)};
}

glm::dvec3 bumped(const glm::dvec3& normal, const glm::dvec3& px, const glm::dvec3& py,
                  const glm::dvec2& rise) {
    const glm::dvec3 r1 = glm::cross(py, normal);
    const glm::dvec3 r2 = glm::cross(normal, px);
    const double det = glm::dot(px, r1);
    if (det == 0.0) {
        return normal;
    }
    const double sign = det > 0.0 ? 1.0 : -1.0;
    return glm::normalize(std::abs(det) * normal - sign * (rise.x * r1 + rise.y * r2));
}

double stored_blurriness(const Focus& focus, double depth_mm) {
    double b = 0.0;
    if (depth_mm < focus.focus_mm) {
        const double f = (depth_mm - focus.focus_mm) / (focus.focus_mm - focus.near_mm);
        b = std::max(-1.0 + 1.0 / (1.0 + std::exp(-10.0 * (f + 0.4))), -focus.clamp_near);
    } else {
        const double f = (depth_mm - focus.focus_mm) / (focus.far_mm - focus.focus_mm);
        b = std::min(1.0 / (1.0 + std::exp(-10.0 * (f - 0.4))), focus.clamp_far);
    }
    return b / 2.0 + 0.5;
}

Buffer organ_picture(const Organ& organ, int width, int height, const glm::dvec4& background) {
    Buffer picture(width, height, 4);
    Buffer depth(width, height, 1, 1.0);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 4; ++c) {
                picture.at(x, y, c) = background[c];
            }
        }
    }
    const std::vector<std::uint32_t> indices = drawing_order(organ);
    rasterise(organ.positions, indices, organ.projection * organ.view,
              {.width = width, .height = height, .snap_bits = 8}, [&](const Fragment& fragment) {
                  const int x = fragment.x;
                  const int y = fragment.y;
                  const Plane plane(organ, fragment.vertices, width, height);
                  if (!(plane.front() ? organ.front : organ.back) || fragment.depth >= depth.at(x, y)) {
                      return;
                  }
                  const Shaded shaded = shade(organ, plane, x, y);
                  if (!organ.blended) {
                      depth.at(x, y) = fragment.depth;
                  }
                  for (int c = 0; c < 4; ++c) {
                      const double behind = organ.blended ? (1.0 - shaded.cover) * picture.at(x, y, c) : 0.0;
                      picture.at(x, y, c) = shaded.colour[c] + behind;
                  }
              });
    return picture;
}

namespace {

/// Of T places read, unlike a disc of N pixels: the variance of the mean is 1/n - 1/N. The 1.75 pixels more,
/// and the factor, are for places that find the same pixel.
double exact_taps(double radius_pixels, int taps) {
    const double pixels =
        std::numbers::pi * (radius_pixels + 1.75) * (radius_pixels + 1.75) * std::max(1.0, taps / 24.0 - 1.0);
    return 1.0 / (1.0 / taps + 1.0 / pixels);
}

bool near_whole(double x) {
    return std::abs(x - std::round(x)) < 1e-4;
}

}  // namespace

int taps_within(double radius_pixels, int taps) {
    return radius_pixels < 0.5 ? 0 : static_cast<int>(std::ceil(exact_taps(radius_pixels, taps)));
}

Buffer depth_of_field(const Buffer& picture, double radius_pixels, const std::vector<glm::dvec2>& spiral,
                      std::vector<char>& undecided) {
    Buffer blurred = picture;
    undecided.assign(static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height), 0);
    const int taps = static_cast<int>(spiral.size());
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            const double b = 2.0 * picture.at(x, y, 3) - 1.0;
            const double radius = std::abs(b) * radius_pixels;
            if (radius < 0.5) {
                continue;
            }
            const int count = taps_within(radius, taps);
            bool close = near_whole(exact_taps(radius, taps));
            glm::dvec3 sum(picture.at(x, y, 0), picture.at(x, y, 1), picture.at(x, y, 2));
            double weights = 1.0;
            for (int tap = 0; tap < count; ++tap) {
                const glm::dvec2 way = radius / std::sqrt(count) * spiral[static_cast<std::size_t>(tap)];
                const glm::dvec2 place = glm::dvec2(x, y) + 0.5 + way;
                close = close || near_whole(place.x) || near_whole(place.y);
                const int i = std::clamp(static_cast<int>(std::floor(place.x)), 0, picture.width - 1);
                const int j = std::clamp(static_cast<int>(std::floor(place.y)), 0, picture.height - 1);
                const double there = 2.0 * picture.at(i, j, 3) - 1.0;
                const double reach = std::abs(there) * radius_pixels;
                const double weight = picture.at(i, j, 3) >= picture.at(x, y, 3)
                                          ? 1.0
                                          : std::clamp(reach - glm::length(way) + 1.0, 0.0, 1.0);
                sum += weight * glm::dvec3(picture.at(i, j, 0), picture.at(i, j, 1), picture.at(i, j, 2));
                weights += weight;
            }
            for (int c = 0; c < 3; ++c) {
                blurred.at(x, y, c) = sum[c] / weights;
            }
            undecided[static_cast<std::size_t>(y * picture.width + x)] = close ? 1 : 0;
        }
    }
    return blurred;
}

}  // namespace viscera::reference

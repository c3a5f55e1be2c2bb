#include "tests/reference/raster.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace viscera::reference {
namespace {

// Keeps the part of a polygon where the plane's side is >= 0; side = dot(plane, clip position).
std::vector<glm::dvec4> clip(const std::vector<glm::dvec4>& polygon, const glm::dvec4& plane) {
    std::vector<glm::dvec4> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec4& a = polygon[i];
        const glm::dvec4& b = polygon[(i + 1) % polygon.size()];
        const double side_a = glm::dot(plane, a);
        const double side_b = glm::dot(plane, b);
        if (side_a >= 0.0) {
            kept.push_back(a);
        }
        if ((side_a >= 0.0) != (side_b >= 0.0)) {
            kept.push_back(a + (b - a) * (side_a / (side_a - side_b)));
        }
    }
    return kept;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

// Whether p lies on the inner side of the edge a -> b of a counter-clockwise triangle. On the edge it belongs
// to the triangle when the edge is a left one (runs down) or a top one (level, runs left).
bool covers(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    const double side = cross(b - a, p - a);
    if (side != 0.0) {
        return side > 0.0;
    }
    return b.y < a.y || (b.y == a.y && b.x < a.x);
}

glm::dvec2 to_pixels(const glm::dvec4& clip_position, const RasterOptions& options) {
    glm::dvec2 p =
        (glm::dvec2(clip_position) / clip_position.w * 0.5 + 0.5) * glm::dvec2(options.width, options.height);
    if (options.snap_bits >= 0) {
        const double grid = std::ldexp(1.0, options.snap_bits);
        p = glm::floor(p * grid + 0.5) / grid;
    }
    return p;
}

// Weights of a triangle's vertices at a pixel, from homogeneous coordinates: no division by a vertex's w, so
// vertices behind the eye do no harm.
class Weights {
  public:
    Weights(const std::array<glm::dvec4, 3>& corners, const RasterOptions& options) {
        std::array<glm::dvec3, 3> rows;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec4& c = corners[i];
            rows[i] = {0.5 * (c.x + c.w) * options.width, 0.5 * (c.y + c.w) * options.height, c.w};
        }
        for (std::size_t i = 0; i < 3; ++i) {
            planes_[i] = glm::cross(rows[(i + 1) % 3], rows[(i + 2) % 3]);
        }
    }
    [[nodiscard]] glm::dvec3 at(double x, double y) const {
        const glm::dvec3 p(x, y, 1.0);
        const glm::dvec3 raw(glm::dot(planes_[0], p), glm::dot(planes_[1], p), glm::dot(planes_[2], p));
        return raw / (raw.x + raw.y + raw.z);
    }

  private:
    std::array<glm::dvec3, 3> planes_;
};

bool finite(const glm::dvec4& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

}  // namespace

void rasterise(std::span<const glm::dvec3> positions, std::span<const std::uint32_t> indices,
               const glm::dmat4& view_projection, const RasterOptions& options,
               const std::function<void(const Fragment&)>& visit) {
    for (std::size_t first = 0; first + 2 < indices.size(); first += 3) {
        Fragment fragment;
        fragment.triangle = static_cast<std::uint32_t>(first / 3);
        std::array<glm::dvec4, 3> corners;
        for (std::size_t i = 0; i < 3; ++i) {
            fragment.vertices[i] = indices[first + i];
            corners[i] = view_projection * glm::dvec4(positions[indices[first + i]], 1.0);
        }
        if (!std::ranges::all_of(corners, finite)) {
            continue;
        }
        std::vector<glm::dvec4> polygon(corners.begin(), corners.end());
        polygon = clip(polygon, {0.0, 0.0, 1.0, 1.0});   // near: z >= -w
        polygon = clip(polygon, {0.0, 0.0, -1.0, 1.0});  // far: z <= w
        std::erase_if(polygon, [](const glm::dvec4& p) { return !(p.w > 0.0); });
        if (polygon.size() < 3) {
            continue;
        }
        const Weights weights(corners, options);
        for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
            const glm::dvec2 a = to_pixels(polygon[0], options);
            glm::dvec2 b = to_pixels(polygon[i], options);
            glm::dvec2 c = to_pixels(polygon[i + 1], options);
            const double area = cross(b - a, c - a);
            if (area == 0.0) {
                continue;
            }
            if (area < 0.0) {
                std::swap(b, c);
            }
            const glm::dvec2 size(options.width - 1, options.height - 1);
            const glm::dvec2 low = glm::max(glm::ceil(glm::min(a, glm::min(b, c)) - 0.5), glm::dvec2(0.0));
            const glm::dvec2 high = glm::min(glm::floor(glm::max(a, glm::max(b, c)) - 0.5), size);
            for (double y = low.y; y <= high.y; y += 1.0) {
                for (double x = low.x; x <= high.x; x += 1.0) {
                    const glm::dvec2 centre(x + 0.5, y + 0.5);
                    if (!covers(a, b, centre) || !covers(b, c, centre) || !covers(c, a, centre)) {
                        continue;
                    }
                    fragment.x = static_cast<int>(x);
                    fragment.y = static_cast<int>(y);
                    fragment.weights = weights.at(centre.x, centre.y);
                    glm::dvec2 zw(0.0);
                    for (int k = 0; k < 3; ++k) {
                        const glm::dvec4& corner = corners[static_cast<std::size_t>(k)];
                        zw += fragment.weights[k] * glm::dvec2(corner.z, corner.w);
                    }
                    fragment.depth = 0.5 * (zw.x / zw.y) + 0.5;
                    visit(fragment);
                }
            }
        }
    }
}

}  // namespace viscera::reference

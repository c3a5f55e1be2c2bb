#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/glm.hpp>

namespace viscera {

[[nodiscard]] inline double cross2(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// Weights closer to 0 than this count as 0: rounding must not leave a gap between two triangles.
inline constexpr double on_texel_edge = 1e-9;

/// Calls visit(x, y, b1, b2) for every texel whose centre (x + 0.5, y + 0.5) lies in the closed triangle,
/// with the weights of corners 1 and 2 there. Corners in texels; x and y may lie outside any texture. A
/// triangle without area has no texels. False, and nothing visited, for one that spans more than `most`
/// texels in x or y, lest a wild coordinate take forever.
template <class Visit>
bool for_each_texel(const std::array<glm::dvec2, 3>& corner, int most, Visit&& visit) {
    const glm::dvec2 e1 = corner[1] - corner[0];
    const glm::dvec2 e2 = corner[2] - corner[0];
    const double area = cross2(e1, e2);
    if (!(std::abs(area) > 0.0)) {
        return true;
    }
    const glm::dvec2 low = glm::min(corner[0], glm::min(corner[1], corner[2]));
    const glm::dvec2 high = glm::max(corner[0], glm::max(corner[1], corner[2]));
    constexpr double farthest = 1e9;
    if (!(std::max(high.x - low.x, high.y - low.y) <= most) ||
        !(std::max({-low.x, -low.y, high.x, high.y}) < farthest)) {
        return false;
    }
    const auto first = [](double x) { return static_cast<int>(std::ceil(x - 0.5)); };
    const auto last = [](double x) { return static_cast<int>(std::floor(x - 0.5)); };
    for (int y = first(low.y); y <= last(high.y); ++y) {
        for (int x = first(low.x); x <= last(high.x); ++x) {
            const glm::dvec2 q = glm::dvec2(x + 0.5, y + 0.5) - corner[0];
            const double b1 = cross2(q, e2) / area;
            const double b2 = cross2(e1, q) / area;
            if (b1 >= -on_texel_edge && b2 >= -on_texel_edge && b1 + b2 <= 1.0 + on_texel_edge) {
                visit(x, y, b1, b2);
            }
        }
    }
    return true;
}

}  // namespace viscera

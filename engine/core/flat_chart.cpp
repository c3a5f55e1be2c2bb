#include "engine/core/flat_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/texel_raster.h"

namespace viscera {

FlatChart::FlatChart(const glm::dvec3& axis)
    : u_(glm::normalize(
          glm::cross(std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0), axis))),
      v_(glm::cross(axis, u_)) {}

void FlatChart::add_triangle(const std::array<glm::dvec3, 3>& corners) {
    triangles_.push_back({flat(corners[0]), flat(corners[1]), flat(corners[2])});
}

void FlatChart::add_border(const std::array<std::uint32_t, 2>& ends,
                           const std::array<glm::dvec3, 2>& points) {
    border_.push_back({ends, flat(points[0]), flat(points[1])});
}

bool FlatChart::cross(const BorderEdge& one, const BorderEdge& other) {
    if (std::ranges::find_first_of(one.ends, other.ends) != one.ends.end()) {
        return false;
    }
    const auto side = [](const BorderEdge& edge, const glm::dvec2& p) {
        return cross2(edge.b - edge.a, p - edge.a);
    };
    return side(one, other.a) * side(one, other.b) < 0.0 && side(other, one.a) * side(other, one.b) < 0.0;
}

bool FlatChart::border_crosses() const {
    std::vector<BorderEdge> border = border_;
    const auto left = [](const BorderEdge& edge) { return std::min(edge.a.x, edge.b.x); };
    const auto right = [](const BorderEdge& edge) { return std::max(edge.a.x, edge.b.x); };
    std::ranges::sort(border, {}, left);
    for (std::size_t i = 0; i < border.size(); ++i) {
        for (std::size_t j = i + 1; j < border.size() && left(border[j]) <= right(border[i]); ++j) {
            if (cross(border[i], border[j])) {
                return true;
            }
        }
    }
    return false;
}

bool FlatChart::covers_twice() const {
    constexpr int side = 256;
    constexpr double inside = 1e-3;
    glm::dvec2 low(std::numeric_limits<double>::max());
    glm::dvec2 high(std::numeric_limits<double>::lowest());
    for (const auto& triangle : triangles_) {
        for (const glm::dvec2& corner : triangle) {
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
    }
    const double scale = side / std::max({high.x - low.x, high.y - low.y, 1e-300});
    std::vector<bool> covered(static_cast<std::size_t>(side) * side, false);
    bool found = false;
    for (const auto& triangle : triangles_) {
        const std::array<glm::dvec2, 3> place{scale * (triangle[0] - low), scale * (triangle[1] - low),
                                              scale * (triangle[2] - low)};
        (void)for_each_texel(place, 2 * side, [&](int x, int y, double b1, double b2) {
            if (x < 0 || y < 0 || x >= side || y >= side || std::min({b1, b2, 1.0 - b1 - b2}) < inside) {
                return;
            }
            const auto i = static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x);
            found = found || covered[i];
            covered[i] = true;
        });
    }
    return found;
}

}  // namespace viscera

#include "effects/tissue/held_triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace viscera::tissue {
namespace {

// A triangle that is so much larger in the texture than others of its size on the surface may lie between
// charts; whether it does is then looked at.
constexpr float suspicious_stretch = 4.0F;

template <class Point>
float perimeter(std::span<const Point> points, std::span<const std::uint32_t> corner) {
    return glm::distance(points[corner[0]], points[corner[1]]) +
           glm::distance(points[corner[1]], points[corner[2]]) +
           glm::distance(points[corner[2]], points[corner[0]]);
}

/// Vertices that belong together, as a forest.
class Groups {
  public:
    explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
    std::uint32_t find(std::uint32_t v) {
        while (parent_[v] != v) {
            v = parent_[v] = parent_[parent_[v]];
        }
        return v;
    }
    void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

  private:
    std::vector<std::uint32_t> parent_;
};

std::vector<float> find_uv_perimeters(const MeshData& mesh) {
    std::vector<float> perimeters(mesh.triangle_count());
    for (std::size_t t = 0; t < perimeters.size(); ++t) {
        perimeters[t] =
            perimeter(std::span<const glm::vec2>(mesh.uvs), std::span(mesh.indices).subspan(3 * t, 3));
    }
    return perimeters;
}

/// Triangles that are too long in the texture, or join what else hangs apart there.
std::vector<char> find_connecting(const MeshData& mesh, std::span<const float> uv_perimeter,
                                  double max_uv_perimeter) {
    const std::size_t count = mesh.triangle_count();
    const auto corners = [&](std::size_t t) { return std::span(mesh.indices).subspan(3 * t, 3); };
    std::vector<char> connecting(count, 0);
    std::vector<float> stretch(count, 0.0F);
    for (std::size_t t = 0; t < count; ++t) {
        const float uv = uv_perimeter[t];
        const float mm = perimeter(std::span<const glm::vec3>(mesh.positions), corners(t));
        connecting[t] = static_cast<double>(uv) <= max_uv_perimeter ? 0 : 1;  // NaN connects
        stretch[t] = mm > 0.0F ? uv / mm : 1e30F;
    }
    if (count == 0) {
        return connecting;
    }
    std::vector<float> sorted = stretch;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::ranges::nth_element(sorted, middle);
    const float most = suspicious_stretch * *middle;
    Groups charts(mesh.positions.size());
    for (std::size_t t = 0; t < count; ++t) {
        if (connecting[t] == 0 && stretch[t] <= most) {
            charts.join(corners(t)[0], corners(t)[1]);
            charts.join(corners(t)[1], corners(t)[2]);
        }
    }
    for (std::size_t t = 0; t < count; ++t) {
        const auto corner = corners(t);
        if (charts.find(corner[0]) != charts.find(corner[1]) ||
            charts.find(corner[1]) != charts.find(corner[2])) {
            // A suspicious triangle that stands alone is a chart of its own, not a bridge.
            connecting[t] = connecting[t] != 0 || stretch[t] > most ? 1 : 0;
        }
    }
    return connecting;
}

}  // namespace

HeldTriangles::HeldTriangles(const MeshData& mesh, std::span<const std::uint32_t> place,
                             double max_uv_perimeter)
    : place_(place.begin(), place.end()),
      first_(place.size() + 1, 0),
      triangles_(mesh.indices.size()),
      uv_perimeter_(find_uv_perimeters(mesh)),
      connecting_(find_connecting(mesh, uv_perimeter_, max_uv_perimeter)),
      held_(mesh.triangle_count(), 0) {
    for (const std::uint32_t v : mesh.indices) {
        ++first_[place_[v] + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        triangles_[next[place_[mesh.indices[i]]]++] = static_cast<std::uint32_t>(i / 3);
    }
}

HoldResult HeldTriangles::hold(std::span<const float> vertices) {
    std::ranges::fill(held_, 0);
    count_ = 0;
    HoldResult result;
    result.shortest_uv_perimeter = std::numeric_limits<float>::infinity();
    for (const float number : vertices) {
        // Written so that NaN is refused.
        if (!(number >= 0.0F && number < static_cast<float>(place_.size()) && number == std::floor(number))) {
            ++result.useless;
            continue;
        }
        const std::uint32_t at = place_[static_cast<std::size_t>(number)];
        for (std::uint32_t i = first_[at]; i < first_[at + 1]; ++i) {
            const std::uint32_t triangle = triangles_[i];
            if (connecting_[triangle] != 0) {
                ++result.connecting;
                result.shortest_uv_perimeter =
                    std::min(result.shortest_uv_perimeter, uv_perimeter_[triangle]);
            } else if (held_[triangle] == 0) {
                held_[triangle] = 1;
                ++count_;
            }
        }
    }
    return result;
}

}  // namespace viscera::tissue

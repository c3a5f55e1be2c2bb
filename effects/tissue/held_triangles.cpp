#include "effects/tissue/held_triangles.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace viscera::tissue {
namespace {

// A triangle that is so much longer and more stretched in the texture than its neighbours may lie between
// charts; whether it does is then looked at.
constexpr float suspicious = 2.0F;

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

/// Per vertex the one that stands for all at its place with its texture coordinates, whatever their normals.
std::vector<std::uint32_t> find_corners(const TexelSurface& surface) {
    const auto key = [&](std::uint32_t v) {
        const glm::vec2 uv = surface.uvs[v] + 0.0F;  // no -0
        return std::tuple(surface.place[v], std::bit_cast<std::uint32_t>(uv.x),
                          std::bit_cast<std::uint32_t>(uv.y));
    };
    std::vector<std::uint32_t> order(surface.uvs.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::sort(order, {}, key);
    std::vector<std::uint32_t> corner(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
        corner[order[i]] = same ? corner[order[i - 1]] : order[i];
    }
    return corner;
}

/// How a triangle, or the least of several, lies in the texture.
struct Lie {
    float length = std::numeric_limits<float>::infinity();   ///< of its longest edge there
    float stretch = std::numeric_limits<float>::infinity();  ///< the most by which an edge is longer there
};

struct Edges {
    Lie lie{0.0F, 0.0F};
    float perimeter = 0.0F;
};

Edges edges_of(const TexelSurface& surface, std::size_t t) {
    Edges edges;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = surface.indices[3 * t + k];
        const std::uint32_t b = surface.indices[3 * t + (k + 1) % 3];
        const float uv = glm::distance(surface.uvs[a], surface.uvs[b]);
        const float length = glm::distance(surface.positions[a], surface.positions[b]);
        edges.perimeter += uv;
        edges.lie.length = std::max(edges.lie.length, uv);
        if (uv > 0.0F) {
            edges.lie.stretch = std::max(edges.lie.stretch, uv / length);
        }
    }
    return edges;
}

std::vector<float> find_uv_perimeters(const TexelSurface& surface) {
    std::vector<float> perimeters(surface.indices.size() / 3);
    for (std::size_t t = 0; t < perimeters.size(); ++t) {
        perimeters[t] = edges_of(surface, t).perimeter;
    }
    return perimeters;
}

}  // namespace

std::vector<char> find_connecting(const TexelSurface& surface, double max_uv_perimeter) {
    const std::size_t count = surface.indices.size() / 3;
    const std::vector<std::uint32_t> corner_of = find_corners(surface);
    const auto corners = [&](std::size_t t) {
        return std::array{corner_of[surface.indices[3 * t]], corner_of[surface.indices[3 * t + 1]],
                          corner_of[surface.indices[3 * t + 2]]};
    };
    std::vector<char> connecting(count, 0);
    std::vector<Lie> least(surface.uvs.size());
    for (std::size_t t = 0; t < count; ++t) {
        const Edges edges = edges_of(surface, t);
        connecting[t] = static_cast<double>(edges.perimeter) <= max_uv_perimeter ? 0 : 1;  // NaN connects
        for (const std::uint32_t v : corners(t)) {
            least[v].length = std::min(least[v].length, edges.lie.length);
            least[v].stretch = std::min(least[v].stretch, edges.lie.stretch);
        }
    }
    // At each corner the least stretched triangle is none of these, so no corner hangs alone.
    const auto may_span = [&](std::size_t t) {
        const Lie lie = edges_of(surface, t).lie;
        return std::ranges::all_of(corners(t), [&](std::uint32_t v) {
            return lie.length > suspicious * least[v].length && lie.stretch > suspicious * least[v].stretch;
        });
    };
    Groups charts(surface.uvs.size());
    std::vector<std::size_t> spanning;
    for (std::size_t t = 0; t < count; ++t) {
        if (may_span(t)) {
            spanning.push_back(t);
        } else if (connecting[t] == 0) {
            charts.join(corners(t)[0], corners(t)[1]);
            charts.join(corners(t)[1], corners(t)[2]);
        }
    }
    for (const std::size_t t : spanning) {
        const auto [a, b, c] = corners(t);
        const bool apart = charts.find(a) != charts.find(b) || charts.find(b) != charts.find(c);
        connecting[t] = connecting[t] != 0 || apart ? 1 : 0;
    }
    return connecting;
}

HeldTriangles::HeldTriangles(const TexelSurface& surface, std::size_t vertex_count, double max_uv_perimeter)
    : vertex_count_(vertex_count),
      place_(surface.place.begin(), surface.place.end()),
      first_(surface.place.size() + 1, 0),
      triangles_(surface.indices.size()),
      uv_perimeter_(find_uv_perimeters(surface)),
      connecting_(find_connecting(surface, max_uv_perimeter)),
      held_(surface.indices.size() / 3, 0) {
    for (const std::uint32_t v : surface.indices) {
        ++first_[place_[v] + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < surface.indices.size(); ++i) {
        triangles_[next[place_[surface.indices[i]]]++] = static_cast<std::uint32_t>(i / 3);
    }
}

HoldResult HeldTriangles::hold(std::span<const float> vertices) {
    std::ranges::fill(held_, 0);
    count_ = 0;
    HoldResult result;
    result.shortest_uv_perimeter = std::numeric_limits<float>::infinity();
    for (const float number : vertices) {
        // Written so that NaN is refused.
        if (!(number >= 0.0F && number < static_cast<float>(vertex_count_) && number == std::floor(number))) {
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

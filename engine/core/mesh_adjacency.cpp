#include "engine/core/mesh_adjacency.h"

#include <algorithm>
#include <compare>
#include <utility>

namespace viscera {
namespace {

struct Edge {
    std::uint32_t low = 0;
    std::uint32_t high = 0;
    std::uint32_t half_edge = 0;
    auto operator<=>(const Edge&) const = default;
    [[nodiscard]] bool same_place(const Edge& other) const { return low == other.low && high == other.high; }
};

// A fan of more triangles about one edge is no pile of sheets, and looking at all pairs would take long.
constexpr std::size_t most_sheets = 64;

/// Half-edges of one edge where more than two triangles meet: those that share their very vertices belong
/// together, as when the sheets of several meshes lie on each other; then the last two that are left, if the
/// surface goes on from one to the other.
void pair_sheets(std::span<const std::uint32_t> indices, std::span<const std::uint32_t> place,
                 std::span<const Edge> group, MeshAdjacency& result) {
    const auto vertices = [&](const Edge& edge) {
        const std::uint32_t a = indices[edge.half_edge];
        const std::uint32_t b = indices[MeshAdjacency::next(edge.half_edge)];
        return std::pair(std::min(a, b), std::max(a, b));
    };
    const auto join = [&](const Edge& a, const Edge& b) {
        result.across[a.half_edge] = b.half_edge;
        result.across[b.half_edge] = a.half_edge;
    };
    std::vector<Edge> left;
    for (const Edge& edge : group) {
        std::size_t same = 0;
        const Edge* other = nullptr;
        for (const Edge& candidate : group) {
            if (candidate.half_edge != edge.half_edge && vertices(candidate) == vertices(edge)) {
                ++same;
                other = &candidate;
            }
        }
        if (same == 1) {
            join(edge, *other);
        } else {
            left.push_back(edge);
        }
    }
    const bool opposite =
        left.size() == 2 && place[indices[left[0].half_edge]] != place[indices[left[1].half_edge]];
    if (opposite) {
        join(left[0], left[1]);
    } else if (left.size() == 1) {
        ++result.open_edges;
    } else if (!left.empty()) {
        ++result.non_manifold_edges;
    }
}

}  // namespace

bool is_collapsed(std::span<const std::uint32_t> indices, std::span<const std::uint32_t> place,
                  std::size_t first) {
    const std::uint32_t a = place[indices[first]];
    const std::uint32_t b = place[indices[first + 1]];
    const std::uint32_t c = place[indices[first + 2]];
    return a == b || b == c || c == a;
}

MeshAdjacency find_adjacency(std::span<const std::uint32_t> indices, std::span<const std::uint32_t> place) {
    MeshAdjacency result;
    result.across.assign(indices.size(), MeshAdjacency::none);
    std::vector<Edge> edges;
    edges.reserve(indices.size());
    for (std::uint32_t t = 0; t + 2 < indices.size(); t += 3) {
        if (is_collapsed(indices, place, t)) {
            continue;
        }
        for (std::uint32_t h = t; h < t + 3; ++h) {
            const std::uint32_t a = place[indices[h]];
            const std::uint32_t b = place[indices[MeshAdjacency::next(h)]];
            edges.push_back({std::min(a, b), std::max(a, b), h});
        }
    }
    std::ranges::sort(edges);
    for (std::size_t first = 0; first < edges.size();) {
        std::size_t end = first + 1;
        while (end < edges.size() && edges[end].same_place(edges[first])) {
            ++end;
        }
        if (end - first == 2) {
            result.across[edges[first].half_edge] = edges[first + 1].half_edge;
            result.across[edges[first + 1].half_edge] = edges[first].half_edge;
        } else if (end - first == 1) {
            ++result.open_edges;
        } else if (end - first > most_sheets) {
            ++result.non_manifold_edges;
        } else {
            pair_sheets(indices, place, std::span(edges).subspan(first, end - first), result);
        }
        first = end;
    }
    return result;
}

}  // namespace viscera

#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace viscera {

/// Which triangles of a mesh meet at which edges. Half-edge 3 t + k runs from corner k of triangle t to
/// corner (k + 1) % 3.
struct MeshAdjacency {
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    /// Per half-edge the one on the other side; none at an open border, and where more than two triangles
    /// meet whose vertices do not say which belong together.
    std::vector<std::uint32_t> across;
    std::size_t open_edges = 0;
    std::size_t non_manifold_edges = 0;

    [[nodiscard]] static constexpr std::uint32_t next(std::uint32_t half_edge) {
        return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
    }
    [[nodiscard]] static constexpr std::uint32_t previous(std::uint32_t half_edge) {
        return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1;
    }
};

/// Whether two corners of the triangle whose first index is `first` are one place, as of half the triangles
/// at the pole of a sphere.
[[nodiscard]] bool is_collapsed(std::span<const std::uint32_t> indices, std::span<const std::uint32_t> place,
                                std::size_t first);

/// `place`: per vertex the vertex that stands for its place, so that triangles which only share places meet
/// too. Triangles may be wound either way. Collapsed ones are left out: what lies on either side of one
/// meets.
[[nodiscard]] MeshAdjacency find_adjacency(std::span<const std::uint32_t> indices,
                                           std::span<const std::uint32_t> place);

}  // namespace viscera

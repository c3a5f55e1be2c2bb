#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

namespace viscera::volume {

/// Distances are told up to this many bricks.
inline constexpr int distance_reach = 31;
/// Between the texels of two kinds of bricks that hold a distance, too.
inline constexpr int kind_step = distance_reach + 1;

/// Room to work in, kept between calls so that nothing is allocated.
struct DistanceScratch {
    std::vector<std::uint8_t> grid, row;
};

/// Chebyshev distance in bricks, cut at `distance_reach`, from each brick of one kind to the nearest of
/// another: all bricks nearer than that are of its own kind, or outside the grid. At least 1. `kinds`: one
/// byte a brick, x fastest; distances of other kinds than `kind` stay as they are. Throws Error(usage) when
/// the number of kinds is not that of the grid.
void distance_to_others(glm::ivec3 dims, std::span<const std::uint8_t> kinds, int kind,
                        std::vector<std::uint8_t>& distance, DistanceScratch& scratch);

/// The same with only those bricks looked at that lie ahead of a straight ray: for each brick the size of the
/// largest cube, up to `distance_reach`, that begins at it, goes on in the ray's direction along every axis,
/// and holds no brick of another kind. What lies behind a ray then does not make its leaps short. Room is
/// kept, so that nothing is allocated from the second time on.
class CubesAhead {
  public:
    /// `kinds`: one byte a brick, x fastest, less than 8. Throws Error(usage) when their number is not that
    /// of the grid.
    void take(glm::ivec3 dims, std::span<const std::uint8_t> kinds);
    /// kind_step * kind + size, one byte a brick, for rays that go up along the axes of which `up` says so,
    /// and down along the others. Holds until the next call.
    [[nodiscard]] std::span<const std::uint8_t> texels(const glm::bvec3& up);

  private:
    glm::ivec3 dims_{0};
    std::vector<std::uint8_t> kinds_;
    std::array<std::vector<std::uint8_t>, 2> along_;  ///< down, up
    std::array<bool, 2> along_known_{};
    std::vector<std::uint8_t> layers_;
    std::vector<std::uint8_t> texels_;
};

}  // namespace viscera::volume

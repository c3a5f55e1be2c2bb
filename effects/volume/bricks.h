#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/volume.h"

namespace viscera::volume {

/// Borders of the bricks of a curvilinear volume. A slab turns through the more voxels the nearer it passes
/// the axis, so that bricks need wider borders there, all around at the axis itself.
struct BrickRows {
    int angle_axis = -1;  ///< 1: a row for each brick along x; 0: for each along y and z; -1: no rows
    bool wrap = false;    ///< ranges include voxels across the seam along angle_axis
    std::vector<glm::ivec3> borders;  ///< [voxels], of each row, y faster than z

    bool operator==(const BrickRows&) const = default;
};

/// Least and greatest stored value over each brick's voxels and a border of the filter's support: bounds of
/// what a reconstruction filter without overshoot can give inside the brick.
struct BrickGrid {
    glm::ivec3 dims{0};  ///< bricks per axis: ceil(volume dims / size)
    int size = 4;        ///< voxels per brick and axis
    int border = 1;      ///< voxels around a brick that its range includes: 1 linear, 2 cubic
    std::vector<float> min;
    std::vector<float> max;
    BrickRows rows{};  ///< curvilinear: borders that differ from row to row

    [[nodiscard]] std::size_t count() const { return min.size(); }
};

/// Voxels per brick and axis for a Cartesian volume of this size: small ones leave out more, but what can be
/// seen in them is to be found anew within a frame, and a texture holds twice as many along each axis.
[[nodiscard]] int brick_size_for(const glm::ivec3& dims);
/// For curvilinear volumes, in which each leap costs as much as two or three slabs.
inline constexpr int curvilinear_brick_size = 4;

/// Ranges of one channel of a volume, in stored units as float; voxels that are not finite count as `empty`
/// (finite). Progress is told after each layer of bricks. Throws Error(usage) for a channel that is not
/// there, size < 1 or border < 0, and Error(usage) "cancelled".
[[nodiscard]] BrickGrid summarise(const Volume& volume, int channel, int size, int border, float empty,
                                  const Progress& progress = {});
/// The same with a border for each row of bricks.
[[nodiscard]] BrickGrid summarise(const Volume& volume, int channel, int size, BrickRows rows, float empty,
                                  const Progress& progress = {});
/// Makes again the bricks that a change of `box` touches (border included); gives a box that holds all that
/// were made again. The part of the box outside the volume is ignored.
VoxelBox resummarise(BrickGrid& bricks, const Volume& volume, int channel, float empty, const VoxelBox& box);

/// Stored values in which something is to be seen, ascending, ends included.
struct StoredRange {
    float low;
    float high;
};

/// How far a Catmull-Rom filter can leave the range of the 4 x 4 x 4 voxels it weighs, as a share of that
/// range. Its weights along one axis add up to 1 and their magnitudes to at most 5/4 (half-way between two
/// voxels), so that the negative weights of three axes add up to at most ((5/4)^3 - 1) / 2.
inline constexpr float catmull_rom_overshoot = 0.4765625F;

/// Which bricks can show anything: those whose [min, max] meets a range and that share a voxel with the crop
/// (in voxels; size 0 along all axes: everything, along some: nothing). [min, max] grows at both ends by
/// `overshoot` * (max - min) first: 0 for filters that weigh with positive weights only. One byte a brick:
/// 1 occupied, 0 empty.
void find_occupied(const BrickGrid& bricks, std::span<const StoredRange> visible, const VoxelBox& crop,
                   std::vector<std::uint8_t>& occupied, float overshoot = 0.0F);

/// Share of occupied bricks, in [0, 1].
[[nodiscard]] double occupancy(std::span<const std::uint8_t> occupied);

}  // namespace viscera::volume

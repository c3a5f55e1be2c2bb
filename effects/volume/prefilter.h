#pragma once

#include <memory>
#include <span>

#include <glm/glm.hpp>

#include "effects/volume/source.h"

namespace viscera::volume {

/// Makes of voxels, in place, the coefficients c whose cubic B-spline passes through them:
/// (c[i-1] + 4 c[i] + c[i+1]) / 6 = voxel i along each axis in turn. Beyond the ends the outermost
/// coefficient goes on, as it does in a texture clamped to its edge. Each line is solved in double precision;
/// slices go to `threads` threads (0: as many as there are processors). voxels: x fastest, dims.x * dims.y *
/// dims.z. `progress` is called on the calling thread; returns false, with the voxels half done, when it said
/// so. `ring`: the axis (0 or 1) along which the coefficients go on at the other end instead; -1: none.
[[nodiscard]] bool make_coefficients(const glm::ivec3& dims, std::span<float> voxels, int threads = 0,
                                     const Progress& progress = {}, int ring = -1);

/// The coefficients of one channel (all_channels: of each) as a source of f32, in stored units; grid,
/// rescaling and statistics are the voxels'. Made on first use and kept in `assets`, those of a file also in
/// its disk cache under the voxels' content; after changes of a live volume made again, where those are small
/// only around them and all around a ring. A change reaches 16 voxels, where it has faded to 1e-9.
[[nodiscard]] std::shared_ptr<const Source> load_coefficients(Assets& assets, const Source& source,
                                                              int channel);

}  // namespace viscera::volume

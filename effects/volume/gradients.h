#pragma once

#include <memory>

#include "effects/volume/source.h"

namespace viscera::volume {

/// Central differences of one channel at its voxels [stored numbers per voxel], one voxel to either side, as
/// a source of four i16 channels: x, y, z and nothing. Between voxels their trilinear mix is the central
/// difference of the trilinear filter, so that one look-up stands for six. `slope` of the volume is the
/// greatest component / 32767: each is off by at most half of it, and a component of 0 is exactly 0. What is
/// not finite counts as the least value. 8 bytes a voxel, in memory and on the GPU. Made on first use and
/// kept in `assets`; of a live volume, changed boxes alone are made again while no component is greater, and
/// the greatest is at least a quarter of what it was when all were made.
[[nodiscard]] std::shared_ptr<const Source> load_gradients(Assets& assets, const Source& source, int channel);

}  // namespace viscera::volume

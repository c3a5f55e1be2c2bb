#pragma once

#include <cstdint>

#include "engine/core/volume.h"

namespace viscera::assets {

/// Pull-back of a rotating intravascular probe through 24 mm of a coronary artery: cylindrical, 360 degrees
/// with wrap, from the catheter's wall at 0.5 mm to a depth of 5 mm; u8, log-compressed echoes with speckle.
/// In it: blood, intima, a plaque with a lipid pool and a calcified arc that casts a shadow, media,
/// adventitia, a side branch, and the guide wire. 112 x 256 x 72 samples for coarser = 1. The frame's z is
/// the artery's way downstream, in the middle of the world's origin.
[[nodiscard]] Volume make_artery(std::uint64_t seed, int coarser = 1);

}  // namespace viscera::assets

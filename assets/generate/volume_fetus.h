#pragma once

#include <cstdint>

#include "engine/core/volume.h"

namespace viscera::assets {

/// Head of an unborn child, 28 weeks, as a volume probe sees it through the belly: spherical, 84 degrees of
/// longitude and 76 of latitude, from the probe's face at 45 mm to a depth of 150 mm; u8, log-compressed
/// echoes with speckle. Skin, skull with the shadow it casts, brain with the middle line, water around it,
/// the womb's wall in front and behind. 128 x 116 x 140 samples for coarser = 1. The frame's x points away
/// from the probe, z to the crown of the head; its origin, the centre of the probe's curvature, is the
/// world's.
[[nodiscard]] Volume make_fetus(std::uint64_t seed, int coarser = 1);

}  // namespace viscera::assets

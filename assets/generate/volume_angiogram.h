#pragma once

#include <cstdint>

#include "assets/generate/vessel_tree.h"
#include "engine/core/volume.h"

namespace viscera::assets {

/// Arteries of an upper abdomen: aorta, coeliac trunk, superior mesenteric and renal arteries, iliacs and
/// their branches. LPS [mm], the aorta along z behind the middle of the box.
[[nodiscard]] VesselTree grow_abdominal_arteries(std::uint64_t seed);

/// Contrast-enhanced MR angiogram of them: u16 without a unit, lumen about 1000, tissue 40 to 230. 192^3
/// voxels of 0.8 mm for coarser = 1, fewer and larger ones for 2, 4 or 8. The same seed gives the same bytes.
[[nodiscard]] Volume make_angiogram(std::uint64_t seed, int coarser = 1);

}  // namespace viscera::assets

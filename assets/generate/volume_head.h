#pragma once

#include <cstdint>

#include "engine/core/volume.h"

namespace viscera::assets {

/// CT of a head that was never anybody's, its segments, and a coarse map over the same box.
struct HeadVolumes {
    Volume ct;         ///< i16, HU: air -1000, sigma of the noise 6
    Volume labels;     ///< u8: a value of HeadLabel
    Volume perfusion;  ///< f32, blood flow [ml / 100 ml / min], 0 outside the brain
};

/// Ids are sparse on purpose: as segmentations come.
enum HeadLabel : std::uint8_t {
    no_label = 0,
    soft_tissue = 1,
    skull = 2,
    mandible = 3,
    brain = 10,
    cerebellum = 11,
    ventricles = 20,
    eyes = 30,
    teeth = 40,
    vertebrae = 50,
    bleed = 200,
};

/// LPS, face towards -y. 192 x 224 x 192 voxels of 1 x 1 x 1.25 mm and a map of 32^3 for coarser = 1; fewer
/// and larger ones over the same box for more. coarser: 1, 2, 4 or 8. The same seed gives the same bytes.
[[nodiscard]] HeadVolumes make_head(std::uint64_t seed, int coarser = 1);

}  // namespace viscera::assets

#pragma once

#include <memory>

#include "effects/volume/classic.h"
#include "effects/volume/light_volume.h"
#include "effects/volume/source.h"

namespace viscera::volume {

/// The colours of a volume of 2 to 4 channels as a source of four u16 channels: red, green, blue and opacity,
/// each a share of the range from the least to the greatest value of all channels, as stored / 65535, so that
/// colours keep their balance. Two channels are grey and opacity; of three the mean is the opacity. Off by at
/// most 1/131070; what is not finite is 0. Made on first use and kept in `assets`; of a live volume, changed
/// boxes alone are made again while its range holds. `channels`: how many the scene counts on. Throws
/// Error(scene) where there are others.
[[nodiscard]] std::shared_ptr<const Source> load_colours(Assets& assets, const Source& source, int channels);

/// What of red, green, blue and opacity is shown, as shares; wide enough for what filters overshoot where the
/// scene sets no limit.
struct ColourLimits {
    glm::dvec4 low{-8.0};
    glm::dvec4 high{8.0};
};
[[nodiscard]] ColourLimits colour_limits(const AccumulateParams& params);

/// Extinction of the voxels of such a source, as glsl/volume/colours.glsl has it. `colours` must outlive it.
/// `diagonal_mm`: of the volume's box.
[[nodiscard]] VoxelExtinction colour_extinction(const Volume& colours, const AccumulateParams& params,
                                                double diagonal_mm);

}  // namespace viscera::volume

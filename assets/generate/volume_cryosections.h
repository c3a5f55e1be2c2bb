#pragma once

#include "assets/generate/volume_head.h"

namespace viscera::assets {

/// The head as photographs of its frozen slices show it: three u8 channels, red, green and blue, over the box
/// of the CT with half as many voxels along each axis; what is around it is black.
[[nodiscard]] Volume make_cryosections(const HeadVolumes& head);

}  // namespace viscera::assets

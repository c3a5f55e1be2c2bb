#pragma once

#include <cstdint>

#include "assets/generate/gray_image.h"
#include "assets/generate/rays.h"

namespace viscera::assets {

/// Chest fluoroscopy without contrast agent, centred on the heart: line integrals through analytic bodies
/// (trunk, lungs with their vessels, heart and great vessels, diaphragm, spine, ribs), exposed as a detector
/// shows them (reduced dynamic range, focal blur, quantum noise). Transmission in [0, 1]: dark is dense.
[[nodiscard]] GrayImage make_thorax(const ConeBeam& beam, std::uint64_t seed);

}  // namespace viscera::assets

#pragma once

#include <cstdint>
#include <span>

#include "engine/core/log.h"

namespace viscera::contrast {

/// Arrival time [s] of what no flow reaches. Finite, so that interpolating it across a triangle stays finite
/// on every GPU, and so late that every bolus is still zero.
inline constexpr float unreached_s = 1.0e9F;

/// What sanitise_density() mended.
struct DensityFaults {
    std::uint64_t not_finite = 0;  ///< NaN, set to 0
    std::uint64_t outside = 0;     ///< below 0 or above 1 (infinities too), clamped
};

/// Brings densities into [0, 1] in place: NaN becomes 0, the rest is clamped.
DensityFaults sanitise_density(std::span<float> density);

/// As above, and counts what it mended under "contrast.density_nan" and "contrast.density_range".
DensityFaults sanitise_density(std::span<float> density, Log& log);

}  // namespace viscera::contrast

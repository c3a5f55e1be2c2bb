#include "effects/contrast/density.h"

#include <algorithm>
#include <cmath>

namespace viscera::contrast {

DensityFaults sanitise_density(std::span<float> density) {
    DensityFaults faults;
    for (float& value : density) {
        if (std::isnan(value)) {
            value = 0.0F;
            ++faults.not_finite;
        } else if (value < 0.0F || value > 1.0F) {
            value = std::clamp(value, 0.0F, 1.0F);
            ++faults.outside;
        }
    }
    return faults;
}

DensityFaults sanitise_density(std::span<float> density, Log& log) {
    const DensityFaults faults = sanitise_density(density);
    if (faults.not_finite > 0) {
        log.fault("contrast.density_nan", "contrast density is NaN at some vertices; taken as 0",
                  faults.not_finite);
    }
    if (faults.outside > 0) {
        log.fault("contrast.density_range", "contrast density lies outside [0, 1] at some vertices; clamped",
                  faults.outside);
    }
    return faults;
}

}  // namespace viscera::contrast

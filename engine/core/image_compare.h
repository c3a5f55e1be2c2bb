#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/image.h"

namespace viscera {

/// What compare() may let pass. All three must hold. Any NaN or Inf in either image fails, whatever the
/// limits.
struct CompareLimits {
    double max = 0.0;   ///< largest absolute difference of any channel
    double mean = 0.0;  ///< mean absolute difference over all pixels and channels
    double fraction =
        0.0;  ///< share of pixels with a channel over `max`, in [0, 1]; those pixels are then let pass
};

struct CompareResult {
    bool equal = false;  ///< within the limits
    std::string reason;  ///< why not; empty when equal
    double max = 0.0;
    double mean = 0.0;
    double rms = 0.0;
    double psnr_db = 0.0;   ///< for a peak of 1; infinity when identical
    double fraction = 0.0;  ///< pixels over limits.max
    std::uint64_t nan = 0;  ///< values that are NaN, in both images together
    std::uint64_t inf = 0;
    int worst_x = -1;  ///< pixel of the largest difference, row 0 at the bottom
    int worst_y = -1;
    int worst_channel = -1;
};

/// Compares pixel by pixel in double precision. Different sizes or channel counts are not equal (and say so).
[[nodiscard]] CompareResult compare(const Image& a, const Image& b, const CompareLimits& limits);

/// Largest channel difference per pixel as a picture (rgba8): black = none, through red and yellow to white =
/// `scale` and above; pixels with NaN or Inf are magenta. Sizes must agree. scale <= 0: the largest
/// difference.
[[nodiscard]] Image heatmap(const Image& a, const Image& b, double scale = 0.0);

}  // namespace viscera

#include "assets/generate/ultrasound_echo.h"

#include <algorithm>
#include <cmath>

#include "assets/generate/noise.h"

namespace viscera::assets {
namespace {

constexpr double mean_length = 0.33;  // of the two noises together
constexpr double range_db = 58.0;

/// Real and imaginary part of the echo. Noise is 0 at each corner of its cells; the two have theirs apart.
glm::dvec2 field(const glm::dvec3& grain, std::uint32_t seed) {
    return {gradient_noise(grain, seed), gradient_noise(grain + glm::dvec3(0.37, 0.51, 0.43), seed + 101U)};
}

}  // namespace

double speckle(const glm::dvec3& grain, std::uint32_t seed) {
    return glm::length(field(grain, seed)) / mean_length;
}

double speckle_around(const glm::dvec3& grain, double around, std::uint32_t seed) {
    // Within the first grains the field of the round before fades out; squares of the shares sum to 1, so
    // that the speckle is as strong there as elsewhere.
    constexpr double fade = 12.0;
    const double share = std::min(1.0, grain.y / fade);
    const glm::dvec2 here = field(grain, seed);
    if (share >= 1.0) {
        return glm::length(here) / mean_length;
    }
    const glm::dvec2 before = field(grain + glm::dvec3(0.0, around, 0.0), seed);
    return glm::length(std::sqrt(share) * here + std::sqrt(1.0 - share) * before) / mean_length;
}

std::byte gray_of(double echo_db, double amplitude) {
    const double db = echo_db + 20.0 * std::log10(std::max(amplitude, 0.05));
    return static_cast<std::byte>(std::clamp(std::lround(255.0 * (1.0 + db / range_db)), 0L, 255L));
}

}  // namespace viscera::assets

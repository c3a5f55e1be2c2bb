#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/glm.hpp>

namespace viscera::assets {

/// Amplitude of fully developed speckle, Rayleigh-like with mean 1: the length of two independent noises with
/// one grain per unit of `grain`.
[[nodiscard]] double speckle(const glm::dvec3& grain, std::uint32_t seed);

/// The same around a ring: `grain.y` in [0, around) grains, with no seam where it begins again.
[[nodiscard]] double speckle_around(const glm::dvec3& grain, double around, std::uint32_t seed);

/// An echo as the scanner shows it: log-compressed, 0 dB is 255 and -58 dB is 0.
[[nodiscard]] std::byte gray_of(double echo_db, double amplitude);

}  // namespace viscera::assets

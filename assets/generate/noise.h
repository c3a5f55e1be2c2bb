#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace viscera::assets {

/// Gradient noise (Perlin 1985, quintic fade): smooth, about [-1, 1], mean 0, one feature per unit length.
[[nodiscard]] double gradient_noise(const glm::dvec3& p, std::uint32_t seed);

/// Fractal sum of `octaves` gradient noises, each twice as fine and half as strong; about [-1, 1].
[[nodiscard]] double fractal_noise(const glm::dvec3& p, int octaves, std::uint32_t seed);

/// Three independent fractal noises: a displacement for warping a domain.
[[nodiscard]] glm::dvec3 fractal_warp(const glm::dvec3& p, int octaves, std::uint32_t seed);

}  // namespace viscera::assets

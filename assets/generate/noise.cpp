#include "assets/generate/noise.h"

#include <array>
#include <cmath>

namespace viscera::assets {
namespace {

std::uint32_t hash(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
    std::uint32_t h = seed * 0x9e3779b1U;
    for (const std::int32_t c : {x, y, z}) {
        h = (h ^ static_cast<std::uint32_t>(c)) * 0x85ebca6bU;
        h ^= h >> 15;
        h *= 0xc2b2ae35U;
        h ^= h >> 13;
    }
    return h;
}

/// Dot product of the offset with one of the 12 edge directions of a cube.
double gradient(std::uint32_t h, double x, double y, double z) {
    const std::uint32_t axis = h % 12U;
    const double first = axis < 8U ? x : y;
    const double second = axis < 4U ? y : z;
    return ((axis & 1U) != 0U ? -first : first) + ((axis & 2U) != 0U ? -second : second);
}

double fade(double t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

}  // namespace

double gradient_noise(const glm::dvec3& p, std::uint32_t seed) {
    const glm::dvec3 base = glm::floor(p);
    const glm::dvec3 f = p - base;
    const glm::ivec3 i(base);
    std::array<double, 2> along_z{};
    for (int k = 0; k < 2; ++k) {
        std::array<double, 2> along_y{};
        for (int j = 0; j < 2; ++j) {
            const double left = gradient(hash(i.x, i.y + j, i.z + k, seed), f.x, f.y - j, f.z - k);
            const double right = gradient(hash(i.x + 1, i.y + j, i.z + k, seed), f.x - 1.0, f.y - j, f.z - k);
            along_y[static_cast<std::size_t>(j)] = glm::mix(left, right, fade(f.x));
        }
        along_z[static_cast<std::size_t>(k)] = glm::mix(along_y[0], along_y[1], fade(f.y));
    }
    return glm::mix(along_z[0], along_z[1], fade(f.z));
}

double fractal_noise(const glm::dvec3& p, int octaves, std::uint32_t seed) {
    double sum = 0.0;
    double amplitude = 1.0;
    double frequency = 1.0;
    for (int octave = 0; octave < octaves; ++octave) {
        sum += amplitude * gradient_noise(p * frequency, seed + static_cast<std::uint32_t>(octave));
        amplitude *= 0.5;
        frequency *= 2.0;
    }
    return sum;
}

glm::dvec3 fractal_warp(const glm::dvec3& p, int octaves, std::uint32_t seed) {
    return {fractal_noise(p, octaves, seed + 101U), fractal_noise(p, octaves, seed + 211U),
            fractal_noise(p, octaves, seed + 307U)};
}

}  // namespace viscera::assets

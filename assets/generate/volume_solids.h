#pragma once

#include <algorithm>
#include <cmath>

#include <glm/glm.hpp>

namespace viscera::assets {

// Signed distances [mm] to bodies that anatomy is put together from, negative inside. Only additions,
// products and square roots: the same bits on every machine.

/// Polynomial smooth minimum, equal to the minimum where |a - b| >= width.
inline float join(float a, float b, float width) {
    const float h = std::max(0.0F, width - std::abs(a - b)) / width;
    return std::min(a, b) - 0.25F * width * h * h;
}

/// `a` without `b`, the edge rounded.
inline float carve(float a, float b, float width) {
    return -join(-a, b, width);
}

/// Nearly the distance to an ellipsoid: exact on its surface, and to first order beside it.
inline float ellipsoid(const glm::vec3& p, const glm::vec3& centre, const glm::vec3& half_lengths) {
    const glm::vec3 scaled = (p - centre) / half_lengths;
    const glm::vec3 twice = scaled / half_lengths;
    const float size = std::sqrt(glm::dot(scaled, scaled));
    const float slope = std::sqrt(glm::dot(twice, twice));
    return slope > 0.0F ? size * (size - 1.0F) / slope
                        : -std::min({half_lengths.x, half_lengths.y, half_lengths.z});
}

inline float sphere(const glm::vec3& p, const glm::vec3& centre, float radius) {
    const glm::vec3 apart = p - centre;
    return std::sqrt(glm::dot(apart, apart)) - radius;
}

/// A thick line whose radius goes from one end's to the other's.
inline float rod(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, float radius_a, float radius_b) {
    const glm::vec3 axis = b - a;
    const float t = std::clamp(glm::dot(p - a, axis) / glm::dot(axis, axis), 0.0F, 1.0F);
    return sphere(p, a + t * axis, radius_a + t * (radius_b - radius_a));
}

/// Like ellipsoid, in a plane.
inline float ellipse(const glm::vec2& p, const glm::vec2& half_lengths) {
    const glm::vec2 scaled = p / half_lengths;
    const glm::vec2 twice = scaled / half_lengths;
    const float size = std::sqrt(glm::dot(scaled, scaled));
    const float slope = std::sqrt(glm::dot(twice, twice));
    return slope > 0.0F ? size * (size - 1.0F) / slope : -std::min(half_lengths.x, half_lengths.y);
}

/// Box with rounded edges; half_lengths include the rounding.
inline float rounded_box(const glm::vec3& p, const glm::vec3& half_lengths, float rounding) {
    const glm::vec3 beyond = glm::abs(p) - half_lengths + rounding;
    const glm::vec3 outside = glm::max(beyond, glm::vec3(0.0F));
    return std::sqrt(glm::dot(outside, outside)) + std::min(0.0F, std::max({beyond.x, beyond.y, beyond.z})) -
           rounding;
}

/// Smooth step from 0 at `low` to 1 at `high`.
inline float step_between(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
    return t * t * (3.0F - 2.0F * t);
}

/// The right half of a symmetric body laid onto its left half.
inline glm::vec3 folded(const glm::vec3& p) {
    return {std::abs(p.x), p.y, p.z};
}

}  // namespace viscera::assets

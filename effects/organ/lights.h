#pragma once

#include <array>
#include <span>

#include "effects/organ/organ_params.h"
#include "engine/core/camera.h"
#include "engine/gl/program.h"

namespace viscera::organ {

/// Whether what comes near it is overexposed.
[[nodiscard]] inline bool glows(const LightParams& light) {
    return light.glow_mm > 0.0 && light.place != LightPlace::infinity;
}

/// Lights as the shader has them: in the eye's axes, counted from the organ's centre.
struct LightUniforms {
    std::array<glm::vec4, most_lights> place{};  ///< w 1: a point [mm]; 0: direction to a light at infinity
    std::array<glm::vec3, most_lights> colour{};
    std::array<glm::vec2, most_lights> fall{};  ///< 1 / falloff^2 [1/mm^2], exponent of the angle
    std::array<glm::vec2, most_lights> glow{};  ///< distance [mm], gain [1/mm^2]
    std::size_t count = 0;
    std::size_t too_far = 0;  ///< counted as at infinity
};

/// centre_in_eye: the organ's centre [mm]. Lights beyond 10^8 mm, or of no finite place, count as at
/// infinity, and as dark where they have a falloff: squares of such distances overflow.
[[nodiscard]] LightUniforms make_lights(std::span<const LightParams> lights, const View& view,
                                        const glm::dvec3& centre_in_eye);

void set_lights(const gl::Program& program, const LightUniforms& lights);

}  // namespace viscera::organ

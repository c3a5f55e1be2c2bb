#pragma once

#include <array>
#include <span>

#include "effects/organ/organ_params.h"
#include "engine/core/camera.h"
#include "engine/gl/program.h"

namespace viscera::organ {

/// Lights as the shader has them: in the eye's axes, counted from the organ's centre.
struct LightUniforms {
    std::array<glm::vec4, most_lights> place{};  ///< w 1: a point [mm]; 0: direction to a light at infinity
    std::array<glm::vec3, most_lights> colour{};
    std::array<glm::vec2, most_lights> fall{};  ///< 1 / falloff^2 [1/mm^2], exponent of the angle
    std::array<glm::vec2, most_lights> glow{};  ///< distance [mm], gain [1/mm^2]
    std::size_t count = 0;
};

/// centre_in_eye: the organ's centre [mm]. Lights beyond 10^8 mm, or of no finite place, count as at
/// infinity: squares of such distances overflow, and what falls off has ended long before.
[[nodiscard]] LightUniforms make_lights(std::span<const LightParams> lights, const View& view,
                                        const glm::dvec3& centre_in_eye);

void set_lights(const gl::Program& program, const LightUniforms& lights);

}  // namespace viscera::organ

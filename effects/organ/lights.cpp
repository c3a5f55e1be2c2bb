#include "effects/organ/lights.h"

#include <algorithm>
#include <cmath>

namespace viscera::organ {
namespace {

constexpr double farthest_light_mm = 1e8;
constexpr double steepest = 1e30;  // as a float, and of a distance of 0 still 0

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return largest > 0.0 && std::isfinite(largest) ? glm::normalize(v / largest) : glm::dvec3(0.0);
}

}  // namespace

LightUniforms make_lights(std::span<const LightParams> lights, const View& view,
                          const glm::dvec3& centre_in_eye) {
    LightUniforms made;
    made.count = std::min(lights.size(), most_lights);
    for (std::size_t i = 0; i < made.count; ++i) {
        const LightParams& light = lights[i];
        glm::dvec3 place = light.position;
        bool far = light.place == LightPlace::infinity;
        if (far) {
            place = glm::dmat3(view.view) * place;
        } else {
            place = light.place == LightPlace::world ? glm::dvec3(view.view * glm::dvec4(place, 1.0))
                                                     : place + view.camera_in_eye_mm;
            place -= centre_in_eye;
            far = !(glm::length(place) <= farthest_light_mm);
        }
        made.too_far += far && light.place != LightPlace::infinity ? 1 : 0;
        const bool ended = far && light.place != LightPlace::infinity && light.falloff_mm > 0.0;
        made.place[i] =
            far ? glm::vec4(glm::vec3(unit_or_zero(place)), 0.0F) : glm::vec4(glm::vec3(place), 1.0F);
        made.colour[i] = ended ? glm::vec3(0.0F) : glm::vec3(light.colour);
        const double falloff = far ? 0.0 : light.falloff_mm;
        made.fall[i] =
            glm::vec2(falloff > 0.0 ? std::min(1.0 / (falloff * falloff), steepest) : 0.0, light.angular);
        made.glow[i] = glm::vec2(far ? 0.0 : light.glow_mm, std::min(light.glow_per_mm2, steepest));
    }
    return made;
}

void set_lights(const gl::Program& program, const LightUniforms& lights) {
    if (lights.count == 0) {
        return;
    }
    program.set("u_light_place", std::span<const glm::vec4>(lights.place).first(lights.count));
    program.set("u_light_colour", std::span<const glm::vec3>(lights.colour).first(lights.count));
    program.set("u_light_fall", std::span<const glm::vec2>(lights.fall).first(lights.count));
    program.set("u_light_glow", std::span<const glm::vec2>(lights.glow).first(lights.count));
}

}  // namespace viscera::organ

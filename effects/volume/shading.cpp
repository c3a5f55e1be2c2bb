#include "effects/volume/shading.h"

#include <algorithm>
#include <array>

#include "engine/core/error.h"

namespace viscera::volume {

void LightParams::visit(ParamVisitor& v) {
    v.field({.name = "direction", .doc = "Towards the light, in the world."}, direction);
    v.field({.name = "position_mm", .doc = "Where the light is, in the world.", .unit = "mm"}, position_mm);
    v.field({.name = "colour", .doc = "red, green, blue, linear", .min = 0.0}, colour);
}

glm::dvec4 LightParams::place(const View& view) const {
    if (direction) {
        return {glm::normalize(*direction), 0.0};
    }
    if (position_mm) {
        return {*position_mm, 1.0};
    }
    return view.orthographic ? glm::dvec4(-view.forward, 0.0) : glm::dvec4(view.eye_mm, 1.0);
}

void ShadingParams::visit(ParamVisitor& v) {
    v.field({.name = "enabled", .doc = "Shades; by default as the transfer function's file asks, else not."},
            enabled);
    v.field({.name = "lighting", .doc = "Coefficients; by default those of the transfer function's file."},
            lighting);
    v.field({.name = "lights",
             .doc = "At most 4, each with a direction or a position, or without both in the eye; none: one "
                    "in the eye."},
            lights);
    v.field({.name = "two_sided", .doc = "Surfaces turned away from a light are lit as those turned to it."},
            two_sided);
    v.field({.name = "light_volume", .doc = "Shadow and ambient occlusion."}, light_volume);
}

void ShadingParams::validate() const {
    if (lights.size() > most_lights) {
        throw Error(ErrorCode::scene, "/shading/lights",
                    "at most " + std::to_string(most_lights) + " lights");
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::string where = "/shading/lights/" + std::to_string(i);
        if (lights[i].direction && lights[i].position_mm) {
            throw Error(ErrorCode::scene, where, "has either a direction or a position");
        }
        if (lights[i].direction && !(glm::length(*lights[i].direction) > 1e-150)) {
            throw Error(ErrorCode::scene, where + "/direction", "must not be of length 0");
        }
    }
    if (light_volume.shadow > 0.0 && (lights.empty() || lights.front().at_eye())) {
        throw Error(ErrorCode::scene, "/shading/light_volume/shadow",
                    "a light in the eye throws no shadow that could be seen; give the first light a "
                    "direction or a position");
    }
}

std::vector<std::string> ShadingParams::defines() const {
    std::vector<std::string> names{"SHADING " + std::to_string(std::max<std::size_t>(lights.size(), 1))};
    if (lights.empty() || (lights.size() == 1 && lights.front().at_eye())) {
        names.emplace_back("LIGHT_AT_EYE");
    } else if (!std::ranges::all_of(lights, [](const LightParams& l) { return l.direction.has_value(); })) {
        names.emplace_back("LIGHT_PLACES");
    }
    if (two_sided) {
        names.emplace_back("TWO_SIDED");
    }
    return names;
}

void ShadingParams::set(const gl::Program& program, const TransferFunction& function, const View& view,
                        const glm::dmat4& local_to_world, bool value_rises) const {
    const Lighting light = lighting.value_or(function.lighting);
    // pow(0, 0) is undefined.
    program.set("u_lighting", glm::vec4(glm::dvec4(light.ambient, light.diffuse, light.specular,
                                                   std::max(light.shininess, 1e-3))));
    program.set("u_outward", value_rises ? -1.0F : 1.0F);
    program.set("u_local_to_world", glm::mat4(local_to_world));
    std::array<glm::vec4, most_lights> places{};
    std::array<glm::vec3, most_lights> colours{};
    colours[0] = glm::vec3(1.0F);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        places[i] = lights[i].place(view);
        colours[i] = lights[i].colour;
    }
    const std::size_t count = std::max<std::size_t>(lights.size(), 1);
    program.set("u_lights", std::span<const glm::vec4>(places).first(count));
    program.set("u_light_colours", std::span<const glm::vec3>(colours).first(count));
}

}  // namespace viscera::volume

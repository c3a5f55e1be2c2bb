#include "effects/tissue/gravity.h"

#include <algorithm>
#include <cmath>

#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/runtime/assets.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {

void GravityParams::visit(ParamVisitor& v) {
    v.field({.name = "gravity_m_s2",
             .doc = "Acceleration of what falls, in the world; by default that of a patient on the back.",
             .unit = "m/s^2",
             .min = -most_gravity_m_s2,
             .max = most_gravity_m_s2},
            gravity_m_s2);
    v.field({.name = "host_gravity",
             .doc = "Name of the host's array of 3 floats [m/s^2] that takes its place; empty: none."},
            host_gravity);
    v.field(
        {.name = "spreading",
         .doc = "Least share of gravity that levels a film, however steep the surface: stands for surface "
                "tension.",
         .min = 0.0,
         .max = 1.0},
        spreading);
    v.field({.name = "relief_pull",
             .doc = "Share of gravity with which hollows of the relief draw blood in, whichever way the "
                    "surface faces: stands for surface tension, which does so with (14.5 mm / width from "
                    "hollow to hollow)^2.",
             .min = 0.0,
             .max = 100.0},
            relief_pull);
}

Gravity gravity_of(const GravityParams& params, const HostValues* values, Log& log) {
    glm::dvec3 gravity = params.gravity_m_s2;
    const HostValues::Entry* given =
        values == nullptr || params.host_gravity.empty() ? nullptr : values->find(params.host_gravity);
    if (given != nullptr) {
        const auto& v = given->values;
        // Comparisons are false for what is not a number.
        const auto usable = [](float x) { return std::abs(static_cast<double>(x)) <= most_gravity_m_s2; };
        if (v.size() == 3 && std::ranges::all_of(v, usable)) {
            gravity = {v[0], v[1], v[2]};
        } else {
            log.fault("tissue.gravity",
                      "host values '" + params.host_gravity +
                          "' are not 3 numbers within 1000 m/s^2; the scene's gravity counts");
        }
    }
    const double length = glm::length(gravity);
    if (!(length > 0.0)) {
        log.fault("tissue.no_gravity", "gravity is 0: blood stays where it is");
        return {};
    }
    return {gravity / length, length / standard_gravity_m_s2};
}

std::uint64_t Flow::key() const {
    return Hash()
        .add(gravity.down)
        .add(gravity.strength)
        .add(spreading)
        .add(relief_pull)
        .add(open_edges)
        .value();
}

std::shared_ptr<Flow> flow_over(Assets& assets, std::uint64_t surface) {
    return assets.shared<Flow>(surface, [] { return std::make_shared<Flow>(); });
}

Port read_relief() {
    return {.name = "relief",
            .access = Access::read,
            .target = "tissue.relief",
            .doc =
                "Height [mm] over the mesh, in texture space, of what is too fine for it: blood gathers in "
                "its hollows.",
            .optional = true};
}

double relief_pull(const GravityParams& params, const Prepare& prepare) {
    return prepare.has("relief") ? params.relief_pull : 0.0;
}

void bind_relief(const Pass& pass, const gl::Program& program, double pull) {
    pass.bind(program, "u_relief", "relief", gl::Filter::linear);
    program.set("u_relief_pull", static_cast<float>(pull));
}

}  // namespace viscera::tissue

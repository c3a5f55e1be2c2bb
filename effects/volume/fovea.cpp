#include "effects/volume/fovea.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace viscera::volume {

void FoveaParams::visit(ParamVisitor& v) {
    v.field({.name = "centre",
             .doc = "Where one looks, in UV of the picture, origin at the bottom left.",
             .min = -10.0,
             .max = 10.0},
            centre);
    v.field({.name = "centre_right",
             .doc = "Where the right of two eyes looks; by default as the left one.",
             .min = -10.0,
             .max = 10.0},
            centre_right);
    v.field(
        {.name = "host",
         .doc = "Name of a host's array that says where one looks: u, v, or u and v of the left eye and of "
                "the right one."},
        host);
    v.field({.name = "radius",
             .doc = "Of the disc in which steps are as sampling says, as a share of the picture's height.",
             .min = 0.0,
             .max = 10.0},
            radius);
    v.field({.name = "outer_radius",
             .doc = "From here on steps are step_factor times as long; between the radii they grow smoothly. "
                    "More than radius.",
             .min = 0.0,
             .max = 20.0,
             .min_excluded = true},
            outer_radius);
    v.field({.name = "step_factor", .doc = "How many times as long steps become.", .min = 1.0, .max = 64.0},
            step_factor);
}

void FoveaParams::validate() const {
    if (!(outer_radius > radius)) {
        throw Error(ErrorCode::scene, "/sampling/fovea/outer_radius", "must be more than radius");
    }
}

glm::dvec2 FoveaParams::centre_of(const Frame& frame) const {
    const bool right = frame.eye_index == 1;
    const glm::dvec2 own = right ? centre_right.value_or(centre) : centre;
    const HostValues::Entry* given =
        host.empty() || frame.values == nullptr ? nullptr : frame.values->find(host);
    if (given == nullptr || given->values.size() < 2) {
        return own;
    }
    const std::size_t first = right && given->values.size() >= 4 ? 2 : 0;
    const glm::dvec2 looks(given->values[first], given->values[first + 1]);
    // An eye tracker that has lost the eye says NaN.
    return std::isfinite(looks.x) && std::isfinite(looks.y) ? glm::clamp(looks, -10.0, 10.0) : own;
}

void FoveaParams::set(const gl::Program& program, const glm::dvec2& centre_uv, glm::ivec2 size) const {
    program.set("u_fovea_centre", glm::vec2(centre_uv));
    program.set("u_fovea", glm::vec4(glm::dvec4(static_cast<double>(size.x) / size.y, radius, outer_radius,
                                                step_factor - 1.0)));
}

}  // namespace viscera::volume

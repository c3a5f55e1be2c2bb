#include "effects/tissue/gravity_effect.h"

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {

void GravityMapParams::visit(ParamVisitor& v) {
    gravity.visit(v);
    v.field({.name = "size",
             .doc = "Texels along each side, as the bake's.",
             .unit = "px",
             .min = 16,
             .max = 8192},
            size);
    v.field({.name = "open_edges",
             .doc = "A film runs off where the surface ends; otherwise it stands there as at a wall."},
            open_edges);
}

GravityEffect::GravityEffect() : programs_{{"common/fullscreen.vert", "tissue/gravity.frag", {}}} {}

std::vector<Port> GravityEffect::ports() const {
    const SizeRule size{.width = params_.size, .height = params_.size};
    const auto read = [](const char* name, const char* target, const char* doc) {
        return Port{.name = name, .access = Access::read, .target = target, .doc = doc};
    };
    const auto write = [&](const char* name, const char* target, const char* doc, bool optional) {
        return Port{.name = name,
                    .access = Access::write,
                    .target = target,
                    .doc = doc,
                    .format = PixelFormat::rgba32f,
                    .size = size,
                    .optional = optional,
                    .overwrites = true};
    };
    return {
        read("position", "tissue.position", "Of the bake."),
        read("normal", "tissue.normal", "Of the bake."),
        read("metric", "tissue.metric", "Of the bake."),
        read("seam", "tissue.seam", "Of the bake."),
        write("gravity", "tissue.gravity",
              "Direction downhill in UV, share of gravity along the surface, UV per mm that way.", false),
        write("flow_right", "tissue.flow_right",
              "What drives a film to the texel on the right: levelling, the same for slopes along the face, "
              "fall [mm], area [mm^2]; in gutters the texel where the surface goes on.",
              true),
        write("flow_top", "tissue.flow_top", "The same to the texel above.", true)};
}

Work GravityEffect::prepare(Prepare& prepare) {
    if (!prepare.has("position")) {
        return Work::idle("there is no surface");
    }
    if (prepare.size("position") != prepare.size("gravity")) {
        throw Error(ErrorCode::scene, "/size", "differs from the size of the bake that the pass reads");
    }
    gravity_ = gravity_of(params_.gravity, prepare.frame().values, prepare.log());
    return Work::all(Hash().add(prepare.parameters_key()).add(gravity_.down).add(gravity_.strength).value());
}

void GravityEffect::draw(const Pass& pass) {
    const gl::Program& program = pass.use(0);
    pass.bind(program, "u_position", "position");
    pass.bind(program, "u_normal", "normal");
    pass.bind(program, "u_metric", "metric");
    pass.bind(program, "u_seam", "seam");
    program.set("u_down", glm::vec3(gravity_.down));
    program.set("u_strength", static_cast<float>(gravity_.strength));
    program.set("u_open", params_.open_edges);
    program.set("u_spreading", static_cast<float>(params_.gravity.spreading));
    pass.draw_fullscreen();
}

}  // namespace viscera::tissue

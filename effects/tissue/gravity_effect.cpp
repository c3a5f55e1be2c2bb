#include "effects/tissue/gravity_effect.h"

#include "effects/tissue/baked_surface.h"
#include "engine/core/hash.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {

void GravityMapParams::visit(ParamVisitor& v) {
    gravity.visit(v);
    visit_size(v, size);
    v.field({.name = "open_edges",
             .doc = "Blood runs off where the surface ends; otherwise it stands there as at a wall."},
            open_edges);
}

GravityEffect::GravityEffect()
    : programs_{{"common/fullscreen.vert", "tissue/gravity.frag", {}},
                {"common/fullscreen.vert", "tissue/gravity.frag", {"RELIEF"}}} {}

std::vector<Port> GravityEffect::ports() const {
    const SizeRule size = square(params_.size);
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
        read_bake("position"),
        read_bake("normal"),
        read_bake("metric"),
        read_bake("seam"),
        read_relief(),
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
    check_size(prepare, "gravity");
    gravity_ = gravity_of(params_.gravity, prepare.frame().values, prepare.log());
    relief_pull_ = relief_pull(params_.gravity, prepare);
    *flow_over(prepare.assets(), prepare.subject("position")) = {.known = true,
                                                                 .gravity = gravity_,
                                                                 .spreading = params_.gravity.spreading,
                                                                 .relief_pull = relief_pull_,
                                                                 .open_edges = params_.open_edges};
    return Work::all(Hash().add(prepare.parameters_key()).add(gravity_.down).add(gravity_.strength).value());
}

void GravityEffect::draw(const Pass& pass) {
    const gl::Program& program = pass.use(relief_pull_ > 0.0 ? 1 : 0);
    if (relief_pull_ > 0.0) {
        bind_relief(pass, program, relief_pull_);
    }
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

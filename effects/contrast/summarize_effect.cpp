#include "effects/contrast/summarize_effect.h"

#include "engine/runtime/pass.h"

namespace viscera::contrast {

SummarizeEffect::SummarizeEffect()
    : programs_{{"common/fullscreen.vert", "contrast/summarize.frag", {}},
                {"common/fullscreen.vert", "contrast/summarize.frag", {"THESIS_TRANSITION"}},
                {"common/fullscreen.vert", "contrast/summarize.frag", {"DENSEST"}}} {}

void SummarizeEffect::visit(ParamVisitor& visitor) {
    visitor.field({.name = "transition",
                   .doc = "Where main outweighs the cloud, thesis jumps and smooth blends; with densest the "
                          "cloud never makes "
                          "a vessel lighter."},
                  transition_);
}

std::vector<Port> SummarizeEffect::ports() const {
    return {{.name = "summary",
             .access = Access::write,
             .target = "contrast.summary",
             .doc = "Vessels and cloud together.",
             .passthrough = "main",
             .overwrites = true},
            {.name = "main", .access = Access::read, .target = "contrast.main", .doc = "The vessels."},
            {.name = "cloud",
             .access = Access::read,
             .target = "contrast.cloud",
             .doc = "The cloud.",
             .optional = true}};
}

Work SummarizeEffect::prepare(Prepare& prepare) {
    if (!prepare.has("cloud")) {
        return Work::idle("no injection: the summary is contrast.main itself");
    }
    return Work::all(prepare.parameters_key());
}

void SummarizeEffect::draw(const Pass& pass) {
    const gl::Program& program = pass.use(static_cast<std::size_t>(transition_));
    pass.bind(program, "u_main", "main");
    pass.bind(program, "u_cloud", "cloud");
    pass.draw_fullscreen();
}

}  // namespace viscera::contrast

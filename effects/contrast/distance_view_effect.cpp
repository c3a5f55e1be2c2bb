#include "effects/contrast/distance_view_effect.h"

#include "engine/runtime/pass.h"

namespace viscera::contrast {

DistanceViewEffect::DistanceViewEffect()
    : programs_{{"common/fullscreen.vert", "contrast/distance_view.frag", {}}} {}

std::vector<Port> DistanceViewEffect::ports() const {
    return {{.name = "view",
             .access = Access::write,
             .target = "contrast.distance_view",
             .doc = "Colours for the eye.",
             .format = PixelFormat::rgba8,
             .clear = {0.0F, 0.0F, 0.0F, 1.0F},
             .overwrites = true},
            {.name = "distance",
             .access = Access::read,
             .target = "contrast.distance",
             .doc = "Closeness to the injection."}};
}

Work DistanceViewEffect::prepare(Prepare& prepare) {
    return prepare.has("distance") ? Work::all(prepare.parameters_key())
                                   : Work::idle("no injection at this time");
}

void DistanceViewEffect::draw(const Pass& pass) {
    const gl::Program& program = pass.use(0);
    pass.bind(program, "u_distance", "distance");
    pass.draw_fullscreen();
}

}  // namespace viscera::contrast

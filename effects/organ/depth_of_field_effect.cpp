#include "effects/organ/depth_of_field_effect.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/runtime/pass.h"

namespace viscera::organ {
namespace {

// Below this no other pixel's centre is reached.
constexpr double least_radius_pixels = 0.5;

}  // namespace

void DepthOfFieldParams::visit(ParamVisitor& v) {
    v.field({.name = "radius",
             .doc = "Radius of the blur at blurriness 1, as a fraction of the target's height.",
             .min = 0.0,
             .max = 0.25},
            radius);
    v.field(
        {.name = "taps",
         .doc = "Pixels read for each widely blurred one; as many fewer for one of a small disc as leaves no "
                "more noise.",
         .min = 4,
         .max = 256},
        taps);
    v.field(
        {.name = "largest_blurriness",
         .doc = "That the picture holds: the larger of clamp_near and clamp_far of what drew it. Where it "
                "stands for less than half a pixel the pass rests.",
         .min = 0.0,
         .max = 1.0},
        largest_blurriness);
}

std::vector<glm::dvec2> disc_spiral(int count) {
    const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
    std::vector<glm::dvec2> places;
    for (int i = 0; i < count; ++i) {
        const double radius = std::sqrt(i + 0.5);
        places.emplace_back(radius * std::cos(i * golden_angle), radius * std::sin(i * golden_angle));
    }
    return places;
}

std::vector<Port> DepthOfFieldEffect::ports() const {
    return {{.name = "picture",
             .access = Access::write,
             .target = "final",
             .doc = "The picture with depth of field; alpha as it was.",
             .format = PixelFormat::rgba16f,
             .passthrough = "colour",
             .overwrites = true},
            {.name = "colour",
             .access = Access::read,
             .target = "organ.color",
             .doc = "The picture, with blurriness b as b/2 + 1/2 in alpha."}};
}

std::span<const ProgramDesc> DepthOfFieldEffect::programs() const {
    const std::vector<std::string> defines{"TAPS " + std::to_string(params_.taps)};
    programs_ = {{"common/fullscreen.vert", "organ/depth_of_field.frag", defines, ""},
                 {"", "", defines, "organ/depth_of_field.comp"}};
    return programs_;
}

Work DepthOfFieldEffect::prepare(Prepare& prepare) {
    if (!prepare.has("colour")) {
        return Work::idle("nothing to blur");
    }
    const double radius = params_.radius * prepare.size("picture").y;
    if (radius * params_.largest_blurriness < least_radius_pixels) {
        return Work::idle("nothing is blurred by half a pixel: the picture is its input");
    }
    return Work::all(prepare.parameters_key());
}

void DepthOfFieldEffect::draw(const Pass& pass) {
    const bool compute = pass.compute("picture");
    const gl::Program& program = pass.use(compute ? 1 : 0);
    if (spiral_.size() != static_cast<std::size_t>(params_.taps)) {
        const std::vector<glm::dvec2> places = disc_spiral(params_.taps);
        spiral_.assign(places.begin(), places.end());
    }
    pass.bind(program, "u_picture", "colour", gl::Filter::nearest);
    program.set("u_radius", static_cast<float>(params_.radius * pass.size().y));
    program.set("u_spiral", std::span<const glm::vec2>(spiral_));
    if (compute) {
        pass.dispatch(program, "picture");
    } else {
        pass.draw_fullscreen();
    }
}

}  // namespace viscera::organ

#include "effects/volume/ray_cast_effect.h"

// Rays of the picture, and which of them a pass in mixed resolution casts.
namespace viscera::volume {

/// The full picture's size in pixels, of which a coarse one holds some: that of the surfaces' depth, so that
/// rays end where it is known. Both passes find the same.
glm::ivec2 RayCastEffect::lattice_of(const Frame& frame, glm::ivec2 depth) {
    if (depth.x > 0) {
        return depth;
    }
    const double share = frame.quality.resolution;
    return glm::max(glm::ivec2(glm::round(share * glm::dvec2(frame.width, frame.height))), 1);
}

/// What glsl/volume/ray.glsl, picture.glsl and mixed_lattice.glsl ask for, in any of the pass's programs.
void RayCastEffect::set_picture(const Pass& pass, const RayFrame& frame, const gl::Program& program) const {
    const glm::ivec2 lattice = lattice_of(pass.frame(), depth_size_);
    program.set("u_pixel", 2.0F / glm::vec2(is_coarse() ? lattice : pass.size()));
    program.set("u_lattice", lattice);
    program.set("u_size", pass.size());
    program.set("u_point", std::span<const glm::vec3>(frame.point));
    program.set("u_direction", std::span<const glm::vec3>(frame.direction));
    program.set("u_world_direction", std::span<const glm::vec3>(frame.world_direction));
    program.set("u_near_far", frame.near_far);
    if (variant_.surface) {
        program.set("u_depth_to_share", frame.depth_to_share);
        pass.bind(program, "u_depth", "depth");
    }
    if (variant_.background) {
        pass.bind(program, "u_background", "background");
    }
}

/// Finds which pixels are to be cast, and fills in the others.
void RayCastEffect::fill_in(const Pass& pass, const RayFrame& frame) {
    const auto program_of = [&](std::size_t step, bool given) -> const gl::Program& {
        const gl::Program& program =
            pass.use(variants_.size() + 4 * step + (given ? 2U : 0U) + (variant_.compute ? 1U : 0U));
        set_picture(pass, frame, program);
        pass.bind(program, "u_coarse", "coarse");
        return program;
    };
    const gl::Program& plan = program_of(0, variant_.surface);
    plan.set("u_coarse_tolerance", static_cast<float>(params_.mixed->tolerance));
    plan.set("u_coarse_depth_tolerance", static_cast<float>(params_.mixed->depth_tolerance_mm));
    plan_.draw(pass, plan, variant_.compute);
    const gl::Program& fill = program_of(1, variant_.background);
    pass.bind(fill, "u_plan", plan_.tiles(), gl::Filter::nearest);
    cover(pass, fill);
}

/// Runs the program in use once for each pixel.
void RayCastEffect::cover(const Pass& pass, const gl::Program& program) const {
    if (variant_.compute) {
        pass.dispatch(program, "colour");
    } else {
        pass.draw_fullscreen();
    }
}

}  // namespace viscera::volume

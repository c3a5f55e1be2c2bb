#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "engine/core/shader_source.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/program.h"
#include "engine/gl/raster_state.h"
#include "engine/gl/texture.h"

namespace viscera {
class Pass;
}

namespace viscera::tissue {

/// Programs that step blood: index into blood_programs().
enum class BloodShader : std::size_t {
    start,
    start_spill,
    ground,
    faces,
    link,
    link_relief,
    jump,
    film,
    film_seams,
    film_tools,
    film_tools_seams,
    gutter,
    gutter_seen,
    move,
    move_tools,
    deposited,
    given_up,
    spawned,
    spawned_energy,
    scan,
    search,
    reach,
    near,
    mark_of_drops,
    mark_of_places,
    mark_of_places_energy,
    across,
    settle,
    copy,
    cap,
    lives,
};

[[nodiscard]] std::vector<ProgramDesc> blood_programs();

/// Puts a program in use.
[[nodiscard]] const gl::Program& use(const Pass& pass, BloodShader shader);
/// Binds a target, all of it, and sets the raster state.
void draw_into(const Pass& pass, const gl::Framebuffer& target, const gl::RasterState& state);
void clear(const Pass& pass, const gl::Framebuffer& target, float value = 0.0F);
/// Of two textures that are drawn into at once.
[[nodiscard]] gl::Framebuffer target_of(const gl::Functions& gl, const gl::Texture& first,
                                        const gl::Texture& second, std::string_view label);
/// Texels as they are.
void bind(const Pass& pass, const gl::Program& program, std::string_view uniform, const gl::Texture& texture);

}  // namespace viscera::tissue

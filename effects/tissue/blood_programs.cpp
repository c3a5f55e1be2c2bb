#include "effects/tissue/blood_programs.h"

#include <array>

#include "engine/runtime/pass.h"

namespace viscera::tissue {

std::vector<ProgramDesc> blood_programs() {
    const char* whole = "common/fullscreen.vert";
    const char* tile = "tissue/blood_tile.vert";
    const char* groups = "tissue/drop_groups.vert";
    return {{whole, "tissue/blood_start.frag", {}},
            {whole, "tissue/blood_start.frag", {"SPILL"}},
            {whole, "tissue/blood_ground.frag", {}},
            {whole, "tissue/blood_faces.frag", {}},
            {whole, "tissue/blood_link.frag", {}},
            {whole, "tissue/blood_link.frag", {"RELIEF"}},
            {whole, "tissue/blood_jump.frag", {}},
            {tile, "tissue/blood_film.frag", {"STEP"}},
            {tile, "tissue/blood_film.frag", {"STEP", "SEAMS"}},
            {tile, "tissue/blood_film.frag", {"STEP", "TOOLS"}},
            {tile, "tissue/blood_film.frag", {"STEP", "TOOLS", "SEAMS"}},
            {tile, "tissue/blood_gutter.frag", {"GUTTERS"}},
            {tile, "tissue/blood_gutter.frag", {"CHANGED"}},
            {groups, "tissue/blood_move.frag", {}},
            {groups, "tissue/blood_move.frag", {"TOOLS"}},
            {"tissue/blood_deposit.vert", "tissue/blood_add.frag", {}},
            {"tissue/blood_deposit.vert", "tissue/blood_add.frag", {"WHOLE"}},
            {"tissue/blood_spawn.vert", "tissue/blood_spawn.frag", {}},
            {"tissue/blood_spawn.vert", "tissue/blood_spawn.frag", {"ENERGY"}},
            {whole, "tissue/blood_scan.frag", {}},
            {whole, "tissue/blood_search.frag", {}},
            {whole, "tissue/blood_reach.frag", {}},
            {whole, "tissue/blood_near.frag", {}},
            {"tissue/blood_mark.vert", "tissue/blood_mark.frag", {}},
            {"tissue/blood_mark.vert", "tissue/blood_mark.frag", {"PLACES"}},
            {"tissue/blood_mark.vert", "tissue/blood_mark.frag", {"PLACES", "ENERGY"}},
            {whole, "tissue/blood_across.frag", {}},
            {tile, "tissue/blood_copy.frag", {"SETTLED"}},
            {whole, "tissue/blood_copy.frag", {}},
            {"tissue/blood_cap.vert", "tissue/blood_cap.frag", {}},
            {groups, "tissue/drop_lives.frag", {}}};
}

const gl::Program& use(const Pass& pass, BloodShader shader) {
    return pass.use(static_cast<std::size_t>(shader));
}

void draw_into(const Pass& pass, const gl::Framebuffer& target, const gl::RasterState& state) {
    target.bind();
    gl::apply(pass.gl(), state, {0, 0, target.width(), target.height()});
}

void clear(const Pass& pass, const gl::Framebuffer& target, float value) {
    draw_into(pass, target, gl::overwrite_state);
    target.clear_colour(0, {value, value, value, value});
}

gl::Framebuffer target_of(const gl::Functions& gl, const gl::Texture& first, const gl::Texture& second,
                          std::string_view label) {
    const std::array<const gl::Texture*, 2> colours{&first, &second};
    return {gl, colours, nullptr, label};
}

void bind(const Pass& pass, const gl::Program& program, std::string_view uniform,
          const gl::Texture& texture) {
    pass.bind(program, uniform, texture, gl::Filter::nearest);
}

}  // namespace viscera::tissue

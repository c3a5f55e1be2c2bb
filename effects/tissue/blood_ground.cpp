#include "effects/tissue/blood_ground.h"

#include <algorithm>

#include "effects/tissue/blood_programs.h"
#include "engine/runtime/pass.h"

namespace viscera::tissue {

void BloodGround::take(const Pass& pass, const BloodBlocks& blocks, const gl::Texture& film,
                       const gl::Texture& first_of_cell) {
    constexpr int in_row = BloodBlocks::in_row;
    constexpr int faces_of_block = 160;  // as blood_ground.glsl
    constexpr int texels = BloodBlocks::block_side * BloodBlocks::block_side;
    const int rows = blocks.rows();
    if (!lengths_ || lengths_->height() != rows) {
        target_.reset();
        faces_target_.reset();
        lengths_ = gl::Texture::make_2d(pass.gl(), in_row * texels, rows, PixelFormat::rg32f,
                                        "lengths of texels by blocks");
        across_ = gl::Texture::make_2d(pass.gl(), in_row * texels, rows, PixelFormat::r32f,
                                       "what lies across seams by blocks");
        faces_ = gl::Texture::make_2d(pass.gl(), in_row * faces_of_block, rows, PixelFormat::rgba32f,
                                      "faces by blocks");
        faces_target_.emplace(pass.gl(), *faces_, "faces by blocks");
        target_ = target_of(pass.gl(), *lengths_, *across_, "ground of blood by blocks");
    }
    const gl::Program& program = use(pass, BloodShader::ground);
    bind(pass, program, "u_list", blocks.list());
    bind(pass, program, "u_film", film);
    bind(pass, program, "u_first_of_cell", first_of_cell);
    pass.bind(program, "u_metric", "metric");
    pass.bind(program, "u_right", "flow_right");
    draw_into(pass, *target_, gl::overwrite_state);
    pass.draw_fullscreen();
    const gl::Program& faces = use(pass, BloodShader::faces);
    bind(pass, faces, "u_list", blocks.list());
    pass.bind(faces, "u_right", "flow_right");
    pass.bind(faces, "u_top", "flow_top");
    draw_into(pass, *faces_target_, gl::overwrite_state);
    pass.draw_fullscreen();
}

}  // namespace viscera::tissue

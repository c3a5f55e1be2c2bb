#include "effects/volume/mixed.h"

#include <array>

namespace viscera::volume {
namespace {

constexpr std::array<std::string_view, 2> pass_names{"coarse", "fine"};

}  // namespace

std::span<const std::string_view> choice_names(MixedPass) {
    return pass_names;
}

void MixedParams::visit(ParamVisitor& v) {
    v.field({.name = "pass",
             .doc = "coarse: casts some of the full picture's rays, as many as its target has pixels; fine: "
                    "fills in the others from that, or casts them."},
            pass);
    v.field(
        {.name = "tolerance",
         .doc =
             "Tiles of 4 x 4 pixels in which the coarse picture bends by this or more, in colour or opacity, "
             "from one of its "
             "pixels to the next, are cast (fine); about what linear interpolation would err by. 0: all are.",
         .min = 0.0},
        tolerance);
    v.field({.name = "depth_tolerance_mm",
             .doc = "Tiles in which the depth of surfaces differs by more than this from that interpolated "
                    "from neighbours and from the coarse picture's "
                    "pixels are cast (fine).",
             .unit = "mm",
             .min = 0.0},
            depth_tolerance_mm);
}

int lattice_line(int texel, int texels, int lines) {
    return (2 * texel + 1) * lines / (2 * texels);
}

bool can_fill(glm::ivec2 coarse, glm::ivec2 lattice, glm::ivec2 size) {
    const glm::ivec2 most = glm::min(lattice, size);
    return coarse.x >= 4 && coarse.y >= 4 && coarse.x <= most.x && coarse.y <= most.y;
}

void MixedPlan::draw(const Pass& pass, const gl::Program& program, bool compute) {
    const glm::ivec2 tiles = (pass.size() + tile_size - 1) / tile_size;
    if (!tiles_ || tiles_->width() != tiles.x || tiles_->height() != tiles.y) {
        target_.reset();
        tiles_ = gl::Texture::make_2d(pass.gl(), tiles.x, tiles.y, PixelFormat::r8, "plan of tiles");
        target_.emplace(pass.gl(), *tiles_, "plan of tiles");
    }
    if (compute) {
        pass.dispatch(program, *tiles_);
    } else {
        target_->bind();
        gl::apply(pass.gl(), gl::overwrite_state, {0, 0, tiles.x, tiles.y});
        pass.draw_generated(GL_TRIANGLES, 3, 1);
    }
    pass.bind_target();
    pass.raster(gl::overwrite_state);
}

void MixedPlan::draw_tiles(const Pass& pass) const {
    pass.raster({.program_point_size = true});
    pass.draw_generated(GL_POINTS, tiles_->width() * tiles_->height(), 1);
}

}  // namespace viscera::volume

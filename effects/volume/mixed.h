#pragma once

#include <optional>
#include <span>
#include <string_view>

#include <glm/glm.hpp>

#include "engine/core/params.h"
#include "engine/gl/framebuffer.h"
#include "engine/runtime/pass.h"

namespace viscera::volume {

/// Which of the two passes of a picture in mixed resolution this is.
enum class MixedPass { coarse, fine };
[[nodiscard]] std::span<const std::string_view> choice_names(MixedPass pass);

/// A picture in mixed resolution: a coarse pass casts some of the full picture's rays, a fine one fills in
/// the pixels between where the coarse picture and the surfaces in it are smooth, and casts the rest.
struct MixedParams {
    MixedPass pass = MixedPass::coarse;
    double tolerance = 0.04;
    double depth_tolerance_mm = 0.1;

    void visit(ParamVisitor& v);
};

/// Pixels of the full picture along one axis whose rays the texels of a coarse one hold: texel i has pixel
/// `lattice_line(i, texels, lines)`. texels <= lines: no two texels have one.
[[nodiscard]] int lattice_line(int texel, int texels, int lines);

/// Whether a fine pass of `size` pixels can read a coarse picture: at least four texels along each axis, for
/// the cubic between them, and no more than the full picture and the one that is drawn have pixels.
[[nodiscard]] bool can_fill(glm::ivec2 coarse, glm::ivec2 lattice, glm::ivec2 size);

/// Which pixels of a fine pass are cast and which are filled in: one texel for each tile.
class MixedPlan {
  public:
    static constexpr int tile_size = 4;  ///< [pixels]: what software renderers compute together

    /// Draws it by the program in use, a compute shader if `compute`, for a picture of the pass's size.
    /// Leaves the pass as it was, but for the program.
    void draw(const Pass& pass, const gl::Program& program, bool compute);

    /// Draws the tiles that are cast by the program in use, whose vertex shader is volume/mixed_tiles.vert.
    void draw_tiles(const Pass& pass) const;

    /// 1 where a tile is cast, 0 where it is filled in; after draw().
    [[nodiscard]] const gl::Texture& tiles() const { return *tiles_; }

  private:
    std::optional<gl::Texture> tiles_;
    std::optional<gl::Framebuffer> target_;
};

}  // namespace viscera::volume

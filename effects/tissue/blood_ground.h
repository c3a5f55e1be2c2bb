#pragma once

#include <optional>

#include "effects/tissue/blood_blocks.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/texture.h"

namespace viscera::tissue {

/// What the shaders that draw block by block read of a surface, in the order of the blocks: texels of a block
/// are 8 short rows far apart in a picture, and side by side here.
class BloodGround {
  public:
    /// Of a surface that is new or has moved. `film` knows its cells, `first_of_cell` where the parts of
    /// those at seams begin.
    void take(const Pass& pass, const BloodBlocks& blocks, const gl::Texture& film,
              const gl::Texture& first_of_cell);
    /// Of texels in u and v [mm].
    [[nodiscard]] const gl::Texture& lengths() const { return *lengths_; }
    /// Of gutters the cell across their seam, of cells at seams their first part, or -1.
    [[nodiscard]] const gl::Texture& across() const { return *across_; }

    /// What drives a film through the faces of cells: blood_faces.frag.
    [[nodiscard]] const gl::Texture& faces() const { return *faces_; }

  private:
    std::optional<gl::Texture> lengths_;
    std::optional<gl::Texture> across_;
    std::optional<gl::Texture> faces_;
    std::optional<gl::Framebuffer> target_;
    std::optional<gl::Framebuffer> faces_target_;
};

}  // namespace viscera::tissue

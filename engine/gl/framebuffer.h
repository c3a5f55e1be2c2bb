#pragma once

#include <array>
#include <span>
#include <string_view>

#include "engine/gl/texture.h"

namespace viscera::gl {

/// Textures to draw into: up to draw_buffers colours and one depth (or depth-stencil), all of one size. The
/// textures must outlive it.
class Framebuffer {
  public:
    /// Fragment output i goes to colours[i]; a null entry discards it. Throws Error(gl) naming `label` and
    /// what is incomplete, Error(usage) for sizes that differ or too many colours.
    Framebuffer(const Functions& gl, std::span<const Texture* const> colours, const Texture* depth,
                std::string_view label);
    Framebuffer(const Functions& gl, const Texture& colour, std::string_view label);

    [[nodiscard]] GLuint id() const { return handle_.id(); }
    [[nodiscard]] int width() const { return width_; }    ///< [pixels]
    [[nodiscard]] int height() const { return height_; }  ///< [pixels]

    /// Binds for drawing and reading.
    void bind() const;
    /// Clear one attachment of the framebuffer, which must be bound. Scissor and write masks hold: apply a
    /// raster state first.
    void clear_colour(int index, const std::array<float, 4>& colour) const;
    void clear_depth(float depth) const;

  private:
    FramebufferHandle handle_;
    int width_ = 0;
    int height_ = 0;
};

}  // namespace viscera::gl

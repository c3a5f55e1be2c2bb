#pragma once

#include <span>

#include "effects/tissue/list_texture.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/program.h"
#include "engine/gl/texture.h"

namespace viscera {
class Pass;
}

namespace viscera::tissue {

/// Where gutters lead, as the shaders of drops read it: glsl/tissue/blood_place.glsl.
class BloodJumps {
  public:
    /// `gutters`: x + size * y each; `size`: texels along each side of the film.
    BloodJumps(const gl::Functions& gl, std::span<const int> gutters, int size);

    /// Of a surface that is new or has moved, whose film knows its cells. Leaves a framebuffer of its own
    /// bound.
    void take(const Pass& pass, const gl::Texture& film) const;
    /// For a program with blood_place.glsl or blood_cap.vert.
    void bind(const Pass& pass, const gl::Program& program) const;

  private:
    gl::Texture numbers_;  ///< of gutters in the lists, by texel
    ListTexture gutters_;  ///< x, y
    gl::Texture jumps_;
    gl::Texture slopes_;
    gl::Framebuffer target_;
};

}  // namespace viscera::tissue

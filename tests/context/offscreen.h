#pragma once

#include <array>
#include <cstdint>

#include "engine/gl/functions.h"

namespace viscera::test {

using Rgba8 = std::array<std::uint8_t, 4>;

/// Clears an RGBA8 texture of its own with a colour and reads its last pixel back. Restores nothing.
inline Rgba8 clear_and_read(const gl::Functions& gl, const std::array<float, 4>& colour) {
    constexpr GLsizei side = 8;
    GLuint texture = 0;
    GLuint framebuffer = 0;
    gl.GenTextures(1, &texture);
    gl.BindTexture(GL_TEXTURE_2D, texture);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, side, side, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    gl.GenFramebuffers(1, &framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    gl.ClearBufferfv(GL_COLOR, 0, colour.data());
    Rgba8 pixel{};
    gl.ReadPixels(side - 1, side - 1, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel.data());
    gl.DeleteFramebuffers(1, &framebuffer);
    gl.DeleteTextures(1, &texture);
    return pixel;
}

/// A mark that a context keeps as its own state, by which it is told from others.
inline void mark(const gl::Functions& gl, float value) {
    gl.ClearColor(value, 0.0F, 0.0F, 0.0F);
}
inline float read_mark(const gl::Functions& gl) {
    std::array<float, 4> colour{};
    gl.GetFloatv(GL_COLOR_CLEAR_VALUE, colour.data());
    return colour[0];
}

}  // namespace viscera::test

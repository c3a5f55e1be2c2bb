#pragma once

#include <string>

#include "engine/core/shader_source.h"
#include "engine/gl/framebuffer.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/gl/program.h"
#include "engine/gl/raster_state.h"

namespace viscera::test {

inline ShaderSource shader(std::string text) {
    return {std::move(text), {}, {}};
}

/// One triangle over the whole target, of gl_VertexID alone.
inline ShaderSource full_screen() {
    return shader(
        "#version 330 core\n"
        "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); "
        "}\n");
}

/// A target of a few pixels to draw into.
struct Canvas {
    Canvas(const gl::Functions& gl, int width, int height, PixelFormat format = PixelFormat::rgba32f)
        : texture(gl::Texture::make_2d(gl, width, height, format, "canvas")),
          framebuffer(gl, texture, "canvas") {
        begin(gl, gl::overwrite_state);
        framebuffer.clear_colour(0, {});
    }
    void begin(const gl::Functions& gl, const gl::RasterState& state) const {
        framebuffer.bind();
        gl::apply(gl, state, {0, 0, texture.width(), texture.height()});
    }
    [[nodiscard]] Image read(const gl::Functions& gl) const { return gl::read_texture(gl, texture); }

    gl::Texture texture;
    gl::Framebuffer framebuffer;
};

}  // namespace viscera::test

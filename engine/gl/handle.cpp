#include "engine/gl/handle.h"

#include <array>
#include <span>

namespace viscera::gl {
namespace {

constexpr GLenum context_lost = 0x0507;  // of OpenGL 4.5, from which robust contexts of any version have it

void set_all(const Functions& gl, std::span<const GLenum> zero, GLenum alignment) {
    for (const GLenum parameter : zero) {
        gl.PixelStorei(parameter, 0);
    }
    gl.PixelStorei(alignment, 1);
}

}  // namespace

void toggle(const Functions& gl, GLenum capability, bool on) {
    if (on) {
        gl.Enable(capability);
    } else {
        gl.Disable(capability);
    }
}

void set_tight_packing(const Functions& gl) {
    static constexpr std::array<GLenum, 7> zero{GL_PACK_SWAP_BYTES,   GL_PACK_LSB_FIRST, GL_PACK_ROW_LENGTH,
                                                GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_ROWS, GL_PACK_SKIP_PIXELS,
                                                GL_PACK_SKIP_IMAGES};
    gl.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    set_all(gl, zero, GL_PACK_ALIGNMENT);
}

void set_tight_unpacking(const Functions& gl) {
    static constexpr std::array<GLenum, 7> zero{
        GL_UNPACK_SWAP_BYTES, GL_UNPACK_LSB_FIRST,   GL_UNPACK_ROW_LENGTH, GL_UNPACK_IMAGE_HEIGHT,
        GL_UNPACK_SKIP_ROWS,  GL_UNPACK_SKIP_PIXELS, GL_UNPACK_SKIP_IMAGES};
    gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    set_all(gl, zero, GL_UNPACK_ALIGNMENT);
}

GLenum drain_errors(const Functions& gl) {
    const GLenum first = gl.GetError();
    for (int i = 0; i < 32 && gl.GetError() != GL_NO_ERROR; ++i) {
    }
    return first;
}

const char* error_name(GLenum error) {
    switch (error) {
        case GL_NO_ERROR:
            return "no error";
        case GL_INVALID_ENUM:
            return "invalid enum";
        case GL_INVALID_VALUE:
            return "invalid value";
        case GL_INVALID_OPERATION:
            return "invalid operation";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "invalid framebuffer operation";
        case GL_OUT_OF_MEMORY:
            return "out of memory";
        case context_lost:
            return "context lost";
        default:
            return "unknown error";
    }
}

}  // namespace viscera::gl

#pragma once

#include <utility>

#include "engine/gl/functions.h"

namespace viscera::gl {

/// Name of an OpenGL object, deleted by `Delete` when it is owned. Move-only. The context of `gl` must be
/// current when an owning handle is destroyed; after the context is gone, release() it instead.
template <void (*Delete)(const Functions&, GLuint)>
class Handle {
  public:
    Handle() = default;
    [[nodiscard]] static Handle own(const Functions& gl, GLuint id) { return {gl, id, true}; }
    /// An object of the host's: used, never deleted.
    [[nodiscard]] static Handle wrap(const Functions& gl, GLuint id) { return {gl, id, false}; }

    Handle(Handle&& other) noexcept
        : gl_(other.gl_), id_(std::exchange(other.id_, 0)), owned_(std::exchange(other.owned_, false)) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(gl_, other.gl_);
        std::swap(id_, other.id_);
        std::swap(owned_, other.owned_);
        return *this;
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (owned_ && id_ != 0) {
            Delete(*gl_, id_);
        }
    }

    [[nodiscard]] const Functions& gl() const { return *gl_; }
    [[nodiscard]] GLuint id() const { return id_; }
    [[nodiscard]] bool owned() const { return owned_; }
    /// Gives the object away: it is no longer deleted here, and this handle is empty.
    [[nodiscard]] GLuint release() {
        owned_ = false;
        return std::exchange(id_, 0);
    }

  private:
    Handle(const Functions& gl, GLuint id, bool owned) : gl_(&gl), id_(id), owned_(owned) {}

    const Functions* gl_ = nullptr;
    GLuint id_ = 0;
    bool owned_ = false;
};

// Named functions rather than lambdas: a lambda would be another type in each translation unit.
inline void delete_texture(const Functions& gl, GLuint id) {
    gl.DeleteTextures(1, &id);
}
inline void delete_sampler(const Functions& gl, GLuint id) {
    gl.DeleteSamplers(1, &id);
}
inline void delete_buffer(const Functions& gl, GLuint id) {
    gl.DeleteBuffers(1, &id);
}
inline void delete_vertex_array(const Functions& gl, GLuint id) {
    gl.DeleteVertexArrays(1, &id);
}
inline void delete_framebuffer(const Functions& gl, GLuint id) {
    gl.DeleteFramebuffers(1, &id);
}
inline void delete_query(const Functions& gl, GLuint id) {
    gl.DeleteQueries(1, &id);
}
inline void delete_shader(const Functions& gl, GLuint id) {
    gl.DeleteShader(id);
}
inline void delete_program(const Functions& gl, GLuint id) {
    gl.DeleteProgram(id);
}

using TextureHandle = Handle<delete_texture>;
using SamplerHandle = Handle<delete_sampler>;
using BufferHandle = Handle<delete_buffer>;
using VertexArrayHandle = Handle<delete_vertex_array>;
using FramebufferHandle = Handle<delete_framebuffer>;
using QueryHandle = Handle<delete_query>;
using ShaderHandle = Handle<delete_shader>;
using ProgramHandle = Handle<delete_program>;

/// Texture units that the engine uses. The last one serves for editing textures only, so that creating or
/// filling a texture never disturbs one that is bound for sampling.
inline constexpr GLuint texture_units = 16;
inline constexpr GLuint editing_unit = texture_units - 1;
/// The image unit that compute shaders write their target through.
inline constexpr GLuint image_unit = 0;
/// Draw buffers whose indexed state (colour mask, blending) the engine may touch.
inline constexpr GLuint draw_buffers = 8;
/// Indexed uniform buffer bindings that effects may use.
inline constexpr GLuint uniform_blocks = 8;

/// glEnable or glDisable.
void toggle(const Functions& gl, GLenum capability, bool on);

/// Unbinds pixel buffers and sets all pack (or unpack) parameters to tightly packed rows with alignment 1.
void set_tight_packing(const Functions& gl);
void set_tight_unpacking(const Functions& gl);

/// Forgets pending errors, and afterwards tells whether any came up: for calls that may run out of memory.
/// Bounded, since a lost context reports errors for ever. Returns the first error, or GL_NO_ERROR.
GLenum drain_errors(const Functions& gl);
/// "out of memory", "invalid operation" ...
[[nodiscard]] const char* error_name(GLenum error);

}  // namespace viscera::gl

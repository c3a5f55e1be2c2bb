#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "engine/gl/functions.h"

namespace viscera::gl {

/// Texture targets whose bindings are kept, the last one only where the context is 4.0 or newer.
struct TextureBinding {
    GLenum target;
    GLenum query;
};
inline constexpr std::array<TextureBinding, 11> texture_bindings{
    {{GL_TEXTURE_1D, GL_TEXTURE_BINDING_1D},
     {GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D},
     {GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D},
     {GL_TEXTURE_1D_ARRAY, GL_TEXTURE_BINDING_1D_ARRAY},
     {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
     {GL_TEXTURE_RECTANGLE, GL_TEXTURE_BINDING_RECTANGLE},
     {GL_TEXTURE_BUFFER, GL_TEXTURE_BINDING_BUFFER},
     {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP},
     {GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE},
     {GL_TEXTURE_2D_MULTISAMPLE_ARRAY, GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY},
     {GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY}}};

/// Objects that a test binds to poison the state. Textures in the order of texture_bindings.
struct PoisonObjects {
    std::array<GLuint, texture_bindings.size()> textures{};
    GLuint sampler = 0;
    GLuint buffer = 0;  ///< of at least 64 bytes
    GLuint vertex_array = 0;
    GLuint framebuffer = 0;  ///< complete
    GLuint renderbuffer = 0;
    GLuint program = 0;
    GLuint query = 0;
    GLuint feedback = 0;  ///< 0 below OpenGL 4.0
};

/// One piece of context state: how it is read, set back, and (for tests) changed to what no one expects.
/// Values are stored as 64-bit integers; floating point as its bits.
struct HostStateRow {
    std::string_view name;
    std::size_t slots = 1;  ///< values
    bool raster = false;    ///< a RasterState determines all of it
    bool (*available)(const Functions&) = [](const Functions&) { return true; };
    void (*save)(const Functions&, std::span<GLint64> values) = nullptr;
    void (*restore)(const Functions&, std::span<const GLint64> values) = nullptr;
    void (*poison)(const Functions&, const PoisonObjects&) = nullptr;
};

/// The fixed pipeline. Independent of each other.
[[nodiscard]] std::span<const HostStateRow> fixed_state_rows();
/// What of it there is once per viewport or draw buffer.
[[nodiscard]] std::span<const HostStateRow> indexed_state_rows();
/// Objects bound, in the order in which they must be set back.
[[nodiscard]] std::span<const HostStateRow> binding_rows();

}  // namespace viscera::gl

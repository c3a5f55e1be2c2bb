#pragma once

#include <cstddef>

#include "engine/core/pixel_format.h"
#include "engine/gl/functions.h"

namespace viscera::gl {

/// How OpenGL names a texture's format, and how its pixels lie in memory.
struct TextureFormat {
    GLenum internal = GL_RGBA8;
    GLenum external = GL_RGBA;
    GLenum type = GL_UNSIGNED_BYTE;
    std::size_t bytes_per_pixel = 4;

    bool operator==(const TextureFormat&) const = default;
};

/// In the format's own type: uploads and reads convert nothing.
[[nodiscard]] TextureFormat texture_format(PixelFormat format);

/// 16-bit normalised: the fastest for 8- and 12-bit volumes.
inline constexpr TextureFormat r16_format{GL_R16, GL_RED, GL_UNSIGNED_SHORT, 2};
inline constexpr TextureFormat rgba16_format{GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT, 8};
inline constexpr TextureFormat rgba16_snorm_format{GL_RGBA16_SNORM, GL_RGBA, GL_SHORT, 8};
/// Labels, unfiltered.
inline constexpr TextureFormat r8ui_format{GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, 1};
inline constexpr TextureFormat r16ui_format{GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2};

}  // namespace viscera::gl

#include "engine/gl/format.h"

#include <array>

namespace viscera::gl {

TextureFormat texture_format(PixelFormat format) {
    // In the order of the enumeration.
    static constexpr std::array<GLenum, 10> internal{
        GL_R8,      GL_RG8,  GL_RGBA8, GL_R16F,    GL_RG16F,
        GL_RGBA16F, GL_R32F, GL_RG32F, GL_RGBA32F, GL_DEPTH_COMPONENT32F};
    static constexpr std::array<GLenum, 3> types{GL_UNSIGNED_BYTE, GL_HALF_FLOAT, GL_FLOAT};
    const FormatInfo& entry = info(format);
    const GLenum colour = entry.channels == 1 ? GL_RED : entry.channels == 2 ? GL_RG : GL_RGBA;
    return {internal[static_cast<std::size_t>(format)], entry.is_depth ? GL_DEPTH_COMPONENT : colour,
            types[static_cast<std::size_t>(entry.type)], bytes_per_pixel(format)};
}

}  // namespace viscera::gl

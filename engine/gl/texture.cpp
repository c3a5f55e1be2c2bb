#include "engine/gl/texture.h"

#include <algorithm>
#include <string>

#include "engine/core/error.h"
#include "engine/core/size_text.h"
#include "engine/gl/debug.h"

namespace viscera::gl {
namespace {

std::string to_text(const Extent& extent) {
    const glm::ivec3 size(extent.width, extent.height, extent.depth);
    return size.z == 1 ? size_text(glm::ivec2(size)) : size_text(size);
}

std::size_t texel_count(const Extent& extent) {
    return static_cast<std::size_t>(extent.width) * static_cast<std::size_t>(extent.height) *
           static_cast<std::size_t>(extent.depth);
}

void check_extent(const Functions& gl, GLenum target, const Extent& extent, std::string_view label) {
    GLint limit = 0;
    gl.GetIntegerv(target == GL_TEXTURE_3D ? GL_MAX_3D_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE, &limit);
    GLint depth_limit = limit;
    if (target == GL_TEXTURE_2D_ARRAY) {
        gl.GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &depth_limit);
    }
    const bool some = std::min({extent.width, extent.height, extent.depth}) >= 1;
    if (!some || std::max(extent.width, extent.height) > limit || extent.depth > depth_limit) {
        throw Error(
            ErrorCode::limit, std::string(label),
            "a texture of " + to_text(extent) + " texels cannot be had: each side must be 1 to " +
                std::to_string(limit) + " on this device" +
                (depth_limit == limit ? "" : ", with 1 to " + std::to_string(depth_limit) + " layers"));
    }
}

/// Whether the target takes its texels as a box.
bool has_depth(GLenum target) {
    return target == GL_TEXTURE_3D || target == GL_TEXTURE_2D_ARRAY;
}

}  // namespace

Texture Texture::make(const Functions& gl, GLenum target, Extent extent, TextureFormat format,
                      std::string_view label) {
    check_extent(gl, target, extent, label);
    GLuint id = 0;
    gl.GenTextures(1, &id);
    Texture texture(TextureHandle::own(gl, id), target, extent, format);
    texture.bind_for_editing();
    label_object(gl, GL_TEXTURE, id, label);
    // Without these the object would count as incomplete for lack of mipmaps.
    gl.TexParameteri(target, GL_TEXTURE_BASE_LEVEL, 0);
    gl.TexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
    gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    drain_errors(gl);
    const auto internal = static_cast<GLint>(format.internal);
    if (has_depth(target)) {
        gl.TexImage3D(target, 0, internal, extent.width, extent.height, extent.depth, 0, format.external,
                      format.type, nullptr);
    } else {
        gl.TexImage2D(target, 0, internal, extent.width, extent.height, 0, format.external, format.type,
                      nullptr);
    }
    if (const GLenum error = drain_errors(gl); error != GL_NO_ERROR) {
        throw Error(ErrorCode::limit, std::string(label),
                    "a texture of " + to_text(extent) + " texels (" + std::to_string(texture.bytes()) +
                        " bytes) cannot be had: " + error_name(error));
    }
    return texture;
}

Texture Texture::make_2d(const Functions& gl, int width, int height, TextureFormat format,
                         std::string_view label) {
    return make(gl, GL_TEXTURE_2D, {width, height, 1}, format, label);
}

Texture Texture::make_3d(const Functions& gl, Extent extent, TextureFormat format, std::string_view label) {
    return make(gl, GL_TEXTURE_3D, extent, format, label);
}

Texture Texture::make_2d_array(const Functions& gl, Extent extent, TextureFormat format,
                               std::string_view label) {
    return make(gl, GL_TEXTURE_2D_ARRAY, extent, format, label);
}

Texture Texture::from_image(const Functions& gl, const Image& image, std::string_view label) {
    Texture texture = make_2d(gl, image.width, image.height, image.format, label);
    texture.upload(image);
    return texture;
}

Texture Texture::from_levels(const Functions& gl, std::span<const Image> levels, std::string_view label) {
    Texture texture = from_image(gl, levels.front(), label);
    const TextureFormat& format = texture.format();
    for (std::size_t i = 1; i < levels.size(); ++i) {
        const Image& level = levels[i];
        const bool fits = level.width == std::max(levels[i - 1].width / 2, 1) &&
                          level.height == std::max(levels[i - 1].height / 2, 1) &&
                          level.format == levels.front().format;
        if (!fits) {
            throw Error(ErrorCode::usage, std::string(label), "its levels do not follow each other");
        }
        set_tight_unpacking(gl);
        texture.bind_for_editing();
        gl.TexImage2D(GL_TEXTURE_2D, static_cast<GLint>(i), static_cast<GLint>(format.internal), level.width,
                      level.height, 0, format.external, format.type, level.data.data());
    }
    texture.bind_for_editing();
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(levels.size()) - 1);
    return texture;
}

Texture Texture::from_row(const Functions& gl, std::span<const std::byte> content, TextureFormat format,
                          std::string_view label) {
    GLint limit = 0;
    gl.GetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
    const std::size_t texels = content.size() / format.bytes_per_pixel;
    if (texels < 1 || texels > static_cast<std::size_t>(limit)) {
        throw Error(ErrorCode::limit, std::string(label),
                    "a row of " + std::to_string(texels) + " texels cannot be had: it must have 1 to " +
                        std::to_string(limit) + " on this device");
    }
    GLuint id = 0;
    gl.GenTextures(1, &id);
    Texture texture(TextureHandle::own(gl, id), GL_TEXTURE_BUFFER, {static_cast<int>(texels), 1, 1}, format);
    texture.buffer_.emplace(gl, content, BufferUsage::fixed);
    texture.bind_for_editing();
    label_object(gl, GL_TEXTURE, id, label);
    gl.TexBuffer(GL_TEXTURE_BUFFER, format.internal, texture.buffer_->id());
    return texture;
}

Texture Texture::wrap(const Functions& gl, GLuint id, GLenum target, Extent extent, TextureFormat format) {
    return {TextureHandle::wrap(gl, id), target, extent, format};
}

std::size_t Texture::bytes() const {
    return texel_count(extent_) * format_.bytes_per_pixel;
}

void Texture::upload(std::span<const std::byte> texels) {
    upload_region({0, 0, 0}, extent_, texels);
}

void Texture::upload_region(Extent offset, Extent size, std::span<const std::byte> texels) {
    const auto inside = [](int begin, int length, int whole) {
        return begin >= 0 && length >= 1 && begin <= whole - length;
    };
    if (!inside(offset.width, size.width, extent_.width) ||
        !inside(offset.height, size.height, extent_.height) ||
        !inside(offset.depth, size.depth, extent_.depth)) {
        throw Error(ErrorCode::usage, "texture upload",
                    "a region of " + to_text(size) + " texels lies outside a texture of " + to_text(extent_));
    }
    if (texels.size() != texel_count(size) * format_.bytes_per_pixel) {
        throw Error(ErrorCode::usage, "texture upload",
                    to_text(size) + " texels take " +
                        std::to_string(texel_count(size) * format_.bytes_per_pixel) + " bytes, not " +
                        std::to_string(texels.size()));
    }
    if (buffer_) {
        return buffer_->update(static_cast<std::size_t>(offset.width) * format_.bytes_per_pixel, texels);
    }
    const Functions& api = gl();
    set_tight_unpacking(api);
    bind_for_editing();
    if (has_depth(target_)) {
        api.TexSubImage3D(target_, 0, offset.width, offset.height, offset.depth, size.width, size.height,
                          size.depth, format_.external, format_.type, texels.data());
    } else {
        api.TexSubImage2D(target_, 0, offset.width, offset.height, size.width, size.height, format_.external,
                          format_.type, texels.data());
    }
}

void Texture::upload(const Image& image) {
    if (Extent{image.width, image.height, 1} != extent_ || texture_format(image.format) != format_) {
        throw Error(ErrorCode::usage, "texture upload",
                    "a picture of " + size_text({image.width, image.height}) + " (" +
                        std::string(info(image.format).name) + ") does not fit a texture of " +
                        to_text(extent_) + " texels and " + std::to_string(format_.bytes_per_pixel) +
                        " bytes each");
    }
    upload(std::span<const std::byte>(image.data));
}

void Texture::bind(GLuint unit) const {
    gl().ActiveTexture(GL_TEXTURE0 + unit);
    gl().BindTexture(target_, id());
}

void Texture::bind_for_editing() const {
    bind(editing_unit);
}

}  // namespace viscera::gl

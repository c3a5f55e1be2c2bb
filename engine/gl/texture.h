#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "engine/core/image.h"
#include "engine/gl/buffer.h"
#include "engine/gl/format.h"
#include "engine/gl/handle.h"

namespace viscera::gl {

/// Size of a texture [texels]. One-dimensional data is a 2-D texture of height 1.
struct Extent {
    int width = 0;
    int height = 1;
    int depth = 1;

    bool operator==(const Extent&) const = default;
};

/// A 2-D or 3-D texture, an array of 2-D layers, or a row of texels in a buffer, owned or wrapped, with one
/// level but for from_levels(). How it is filtered is a Sampler's business. All functions that edit it use
/// editing_unit and leave it active.
class Texture {
  public:
    /// Uninitialised storage. Throws Error(limit), which names `label`, when the extent is not positive,
    /// beyond the device's limit, or out of memory.
    [[nodiscard]] static Texture make_2d(const Functions& gl, int width, int height, TextureFormat format,
                                         std::string_view label);
    [[nodiscard]] static Texture make_2d(const Functions& gl, int width, int height, PixelFormat format,
                                         std::string_view label) {
        return make_2d(gl, width, height, texture_format(format), label);
    }
    [[nodiscard]] static Texture make_3d(const Functions& gl, Extent extent, TextureFormat format,
                                         std::string_view label);
    /// extent.depth layers, which are not filtered into each other.
    [[nodiscard]] static Texture make_2d_array(const Functions& gl, Extent extent, TextureFormat format,
                                               std::string_view label);
    [[nodiscard]] static Texture from_image(const Functions& gl, const Image& image, std::string_view label);
    /// A 2-D texture with levels for Filter::trilinear: pictures of one format, each half as wide and high as
    /// the one before, rounded down, and at least 1. Throws Error(usage) for others.
    [[nodiscard]] static Texture from_levels(const Functions& gl, std::span<const Image> levels,
                                             std::string_view label);
    /// A row of texels in a buffer, fetched by number (samplerBuffer) and never filtered: the cheapest way to
    /// a table. `content`: tightly packed; its size is the texture's. Throws Error(limit), which names
    /// `label`, for none, for more than the device takes (at least 65,536), and when out of memory.
    [[nodiscard]] static Texture from_row(const Functions& gl, std::span<const std::byte> content,
                                          TextureFormat format, std::string_view label);
    /// A texture of the host's, which stays the host's. `target`: GL_TEXTURE_2D, GL_TEXTURE_3D or
    /// GL_TEXTURE_2D_ARRAY.
    [[nodiscard]] static Texture wrap(const Functions& gl, GLuint id, GLenum target, Extent extent,
                                      TextureFormat format);

    [[nodiscard]] GLuint id() const { return handle_.id(); }
    [[nodiscard]] bool owned() const { return handle_.owned(); }
    [[nodiscard]] const Functions& gl() const { return handle_.gl(); }
    [[nodiscard]] GLenum target() const { return target_; }
    [[nodiscard]] const Extent& extent() const { return extent_; }
    [[nodiscard]] int width() const { return extent_.width; }
    [[nodiscard]] int height() const { return extent_.height; }
    [[nodiscard]] const TextureFormat& format() const { return format_; }
    /// Bytes of the texels, as the format asks for them.
    [[nodiscard]] std::size_t bytes() const;

    /// All texels, x fastest, row 0 (the bottom) and slice 0 first, tightly packed. Throws Error(usage)
    /// unless exactly bytes() are given.
    void upload(std::span<const std::byte> texels);
    /// The texels of a box within the texture. Throws Error(usage) when it lies outside or the size is wrong.
    void upload_region(Extent offset, Extent size, std::span<const std::byte> texels);
    /// Throws Error(usage) unless the picture's size and format are the texture's.
    void upload(const Image& image);

    /// Binds for sampling. unit < editing_unit.
    void bind(GLuint unit) const;
    void bind_for_editing() const;
    /// Gives the object to the caller, who then deletes it. The texture is empty afterwards.
    [[nodiscard]] GLuint release() { return handle_.release(); }

  private:
    Texture(TextureHandle handle, GLenum target, Extent extent, TextureFormat format)
        : handle_(std::move(handle)), target_(target), extent_(extent), format_(format) {}
    [[nodiscard]] static Texture make(const Functions& gl, GLenum target, Extent extent, TextureFormat format,
                                      std::string_view label);

    TextureHandle handle_;
    GLenum target_ = GL_TEXTURE_2D;
    Extent extent_;
    TextureFormat format_;
    std::optional<Buffer> buffer_;  ///< of a row
};

}  // namespace viscera::gl

#include "effects/tissue/list_texture.h"

#include <algorithm>
#include <bit>

namespace viscera::tissue {

void ListTexture::upload(const gl::Functions& gl, std::span<const glm::vec4> items, std::string_view label) {
    constexpr std::size_t row = 1024;  // as glsl/tissue/list.glsl
    const std::size_t rows = std::max<std::size_t>((items.size() + row - 1) / row, 1);
    if (!texture_ || static_cast<std::size_t>(texture_->height()) < rows) {
        texture_ = gl::Texture::make_2d(gl, static_cast<int>(row), static_cast<int>(std::bit_ceil(rows)),
                                        PixelFormat::rgba32f, label);
    }
    rows_.assign(items.begin(), items.end());
    rows_.resize(rows * row, glm::vec4(0.0F));
    texture_->upload_region({0, 0, 0}, {static_cast<int>(row), static_cast<int>(rows), 1},
                            std::as_bytes(std::span(rows_)));
}

}  // namespace viscera::tissue

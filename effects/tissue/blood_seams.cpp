#include "effects/tissue/blood_seams.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace viscera::tissue {

BloodSeams make_seams(const gl::Functions& gl, std::span<const SeamLink> links, int size) {
    const auto width = static_cast<std::size_t>(size);
    std::vector<float> first_of_cell(width * width);
    const std::vector<SeamLink> parts = links_by_cell(links, first_of_cell);
    std::vector<glm::vec4> items;
    std::ranges::transform(parts, std::back_inserter(items), [](const SeamLink& link) {
        return glm::vec4(link.from, link.to, link.side, link.share);
    });
    gl::Texture first = gl::Texture::make_2d(gl, size, size, PixelFormat::r32f, "parts of cells at seams");
    first.upload(std::as_bytes(std::span(first_of_cell)));
    ListTexture list;
    list.upload(gl, items, "parts of seams");
    gl::Texture pulls = gl::Texture::make_2d(gl, list.texture().width(), list.rows(), PixelFormat::rgba32f,
                                             "fall across seams");
    gl::Framebuffer target(gl, pulls, "fall across seams");
    return {std::move(first), std::move(list), std::move(pulls), std::move(target), links.empty()};
}

}  // namespace viscera::tissue

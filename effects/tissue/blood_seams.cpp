#include "effects/tissue/blood_seams.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace viscera::tissue {

BloodSeams make_seams(const gl::Functions& gl, std::span<const SeamLink> links, int size) {
    const auto width = static_cast<std::size_t>(size);
    const SeamParts seams = seam_parts(links, width * width);
    std::vector<glm::vec4> items;
    std::ranges::transform(seams.links, std::back_inserter(items), [](const SeamLink& link) {
        return glm::vec4(link.from, link.to, link.side, link.share);
    });
    ListTexture link_list;
    link_list.upload(gl, items, "links across seams");
    items.clear();
    std::ranges::transform(seams.parts, std::back_inserter(items), [](const SeamPart& part) {
        return glm::vec4(part.first, part.count, part.to, part.ends);
    });
    ListTexture part_list;
    part_list.upload(gl, items, "parts of seams");
    gl::Texture first = gl::Texture::make_2d(gl, size, size, PixelFormat::r32f, "parts of cells at seams");
    first.upload(std::as_bytes(std::span(seams.first)));
    gl::Texture pulls = gl::Texture::make_2d(gl, part_list.texture().width(), part_list.rows(),
                                             PixelFormat::rgba32f, "fall across seams");
    gl::Framebuffer target(gl, pulls, "fall across seams");
    return {std::move(first), std::move(link_list), std::move(part_list),
            std::move(pulls), std::move(target),    links.empty()};
}

}  // namespace viscera::tissue

#include "effects/tissue/blood_seams.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

namespace viscera::tissue {
namespace {

SeamPairs pairs_of(const gl::Functions& gl, std::span<const SeamLink> links, std::span<const SeamJump> jumps,
                   int size, int side) {
    std::vector<std::array<int, 4>> found;
    found.reserve(2 * links.size() + jumps.size());
    const auto add = [&](int from, int to) {
        found.push_back({from % size / side, from / size / side, to % size / side, to / size / side});
    };
    for (const SeamLink& link : links) {
        // What flows one way must be seen from the other side as well.
        add(static_cast<int>(link.from), static_cast<int>(link.to));
        add(static_cast<int>(link.to), static_cast<int>(link.from));
    }
    // A drop leaves blood where the gutter below it leads.
    for (const SeamJump& jump : jumps) {
        add(jump.gutter, jump.to);
    }
    std::ranges::sort(found);
    found.erase(std::ranges::unique(found).begin(), found.end());
    std::vector<glm::vec4> texels;
    std::ranges::transform(found, std::back_inserter(texels), [](const std::array<int, 4>& pair) {
        return glm::vec4(glm::ivec4(pair[0], pair[1], pair[2], pair[3]));
    });
    SeamPairs pairs{.count = static_cast<int>(found.size())};
    pairs.list.upload(gl, texels, "squares that seams join");
    return pairs;
}

}  // namespace

BloodSeams make_seams(const gl::Functions& gl, std::span<const SeamLink> links,
                      std::span<const SeamJump> jumps, int size, int tile_side, int block_side) {
    std::vector<float> first_of_cell(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    std::vector<glm::vec4> by_cell;
    std::ranges::transform(
        links_by_cell(links, first_of_cell), std::back_inserter(by_cell),
        [](const SeamLink& link) { return glm::vec4(link.from, link.to, link.side, link.share); });
    gl::Texture first = gl::Texture::make_2d(gl, size, size, PixelFormat::r32f, "cells at seams");
    first.upload(std::as_bytes(std::span(first_of_cell)));
    ListTexture listed;
    listed.upload(gl, by_cell, "parts of seams");
    gl::Texture pulls = gl::Texture::make_2d(gl, listed.texture().width(), listed.rows(),
                                             PixelFormat::rgba32f, "fall across seams");
    gl::Framebuffer pulls_target(gl, pulls, "fall across seams");
    return {pairs_of(gl, links, jumps, size, tile_side),
            pairs_of(gl, links, jumps, size, block_side),
            std::move(first),
            std::move(listed),
            std::move(pulls),
            std::move(pulls_target)};
}

}  // namespace viscera::tissue

#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/image.h"

namespace viscera::tissue {

/// A part of a seam that joins a cell to one across it, as the shaders read it (RGBA32F).
struct SeamLink {
    float from = 0.0F;   ///< cell, x + width * y
    float to = 0.0F;     ///< cell across the seam
    float side = 0.0F;   ///< of `from`: 0 right, 1 left, 2 top, 3 bottom; 4 more: see links_by_cell()
    float share = 0.0F;  ///< of their common face; negative: see links_by_cell()
};

/// The parts of all seams. Each face between a cell and its gutter goes to the cells around the point at
/// which the surface goes on there, by linear weights that sum to one half: the other side of the seam has
/// its own faces, which carry the other half. Both chart and texture may lie there in any way. `position`,
/// `seam`: RGBA32F and RG32F of the bake, of one size.
[[nodiscard]] std::vector<SeamLink> seam_links(const Image& position, const Image& seam);

/// A texel of a gutter, and the one in which the surface goes on there: x + width * y each.
struct SeamJump {
    int gutter = 0;
    int to = 0;
};
[[nodiscard]] std::vector<SeamJump> seam_jumps(const Image& position, const Image& seam);

/// Texels of gutters: x + width * y each, rising.
[[nodiscard]] std::vector<int> seam_gutters(const Image& position, const Image& seam);

/// Links in the order of the cells that they change, each twice: once for its `from`, and once for its
/// `to`, with a negative share. `side` is 4 more in the last one of each cell. `first`, by cell, gets the
/// index of its first one, or -1.
[[nodiscard]] std::vector<SeamLink> links_by_cell(std::span<const SeamLink> links, std::span<float> first);

}  // namespace viscera::tissue

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/image.h"

namespace viscera::tissue {

/// Joins a face of a cell at a seam to a cell across, as the shaders read it (RGBA32F).
struct SeamLink {
    float from = 0.0F;   ///< cell, x + width * y
    float to = 0.0F;     ///< cell across the seam
    float side = 0.0F;   ///< of `from`: 0 right, 1 left, 2 top, 3 bottom
    float share = 0.0F;  ///< of their common face; negative: see seam_parts()
};

/// The links of all seams. Each face between a cell and its gutter goes to the cells around the point at
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

/// All that joins a cell to one across a seam, as the shaders read it (RGBA32F).
struct SeamPart {
    float first = 0.0F;  ///< of its links
    float count = 0.0F;  ///< of its links
    float to = 0.0F;     ///< cell across the seam
    float ends = 0.0F;   ///< 1 in the last part of a cell
};

/// Seams by the cells that they change.
struct SeamParts {
    std::vector<SeamLink> links;  ///< twice: for the `from` of each, and, with a negative share, for its `to`
    std::vector<SeamPart> parts;
    std::vector<float> first;  ///< by cell: of its parts, or -1
};
/// `cells`: of the texture. Both cells that a part joins have the same links in the same order, so that they
/// sum up to the same.
[[nodiscard]] SeamParts seam_parts(std::span<const SeamLink> links, std::size_t cells);

}  // namespace viscera::tissue

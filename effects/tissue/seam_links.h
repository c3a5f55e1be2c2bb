#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "engine/core/image.h"

namespace viscera::tissue {

/// A part of a seam that joins a cell to one across it, as the shaders read it (RGBA32F).
struct SeamLink {
    float from = 0.0F;   ///< cell, x + width * y
    float to = 0.0F;     ///< cell across the seam
    float side = 0.0F;   ///< of `from`: 0 right, 1 left, 2 top, 3 bottom
    float share = 0.0F;  ///< of their common face
};

/// The parts of all seams. Each face between a cell and its gutter goes to the cells around the point at
/// which the surface goes on there, by linear weights that sum to one half: the other side of the seam has
/// its own faces, which carry the other half. Both chart and texture may lie there in any way. `position`,
/// `seam`: RGBA32F and RG32F of the bake, of one size.
[[nodiscard]] std::vector<SeamLink> seam_links(const Image& position, const Image& seam);

}  // namespace viscera::tissue

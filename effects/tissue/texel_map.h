#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/mesh_data.h"

namespace viscera::tissue {

/// Which point of a surface a texel stands for: on `triangle`, at the weights (1 - b1 - b2, b1, b2) of its
/// corners. Laid out as the RGBA32F texture that the bake's shader reads.
struct TexelPoint {
    float triangle = 0.0F;
    float b1 = 0.0F;
    float b2 = 0.0F;
    /// 0: the texel stands for nothing. i + 1: it lies in triangle i of a chart. -(i + 1): it lies in the
    /// gutter beside triangle i, whose map continues there.
    float owner = 0.0F;
};

/// What was found while a map was made.
struct TexelMapFaults {
    std::size_t overlapping_texels = 0;  ///< texels that lie in more than one triangle
};

struct TexelMap {
    int size = 0;                    ///< texels along each side
    std::vector<TexelPoint> texels;  ///< size * size, the bottom row first
    TexelMapFaults faults;
};

/// Every texel whose centre lies in a triangle. Texture coordinates beyond [0, 1] repeat.
[[nodiscard]] TexelMap make_texel_map(const MeshData& mesh, int size);

}  // namespace viscera::tissue

#pragma once

#include <cstddef>

#include <glm/glm.hpp>

namespace viscera {

/// Number of a pixel, texel or tile, counted row by row.
[[nodiscard]] constexpr std::size_t pixel_index(int x, int y, int width) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

/// Number of a voxel or brick, x fastest.
[[nodiscard]] constexpr std::size_t voxel_index(const glm::ivec3& at, const glm::ivec3& dims) {
    return static_cast<std::size_t>(dims.x) * pixel_index(at.y, at.z, dims.y) +
           static_cast<std::size_t>(at.x);
}

}  // namespace viscera

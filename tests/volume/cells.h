#pragma once

#include <cstddef>

#include <glm/glm.hpp>

// Grids of voxels or bricks, as tests go through them.

namespace viscera::volume {

[[nodiscard]] inline std::size_t count_of(const glm::ivec3& dims) {
    return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
           static_cast<std::size_t>(dims.z);
}

/// Calls act(number, index) for each cell, x fastest.
void for_each(const glm::ivec3& dims, const auto& act) {
    std::size_t i = 0;
    for (int z = 0; z < dims.z; ++z) {
        for (int y = 0; y < dims.y; ++y) {
            for (int x = 0; x < dims.x; ++x) {
                act(i++, glm::ivec3(x, y, z));
            }
        }
    }
}

}  // namespace viscera::volume

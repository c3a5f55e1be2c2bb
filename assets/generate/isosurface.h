#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <glm/glm.hpp>

namespace viscera::assets {

/// A surface of four-sided faces, counter-clockwise seen from outside (where the field is positive).
struct QuadMesh {
    std::vector<glm::dvec3> vertices;
    std::vector<std::array<std::uint32_t, 4>> quads;
};

/// Grid points along one edge of a block of the narrow band.
inline constexpr int block_size = 8;

/// Zero surface of a field that is negative inside, by dual marching cubes: one vertex per piece of surface
/// in a cell, so that sheets which share a cell stay apart, and ambiguous faces are decided alike from both
/// sides. The field is sampled at spacing times integer points, in the given blocks (block b holds the points
/// block_size b .. block_size b + block_size - 1 on each axis), and taken as positive everywhere else.
[[nodiscard]] QuadMesh extract_isosurface(const std::function<double(const glm::dvec3&)>& field,
                                          const std::vector<glm::ivec3>& blocks, double spacing);

}  // namespace viscera::assets

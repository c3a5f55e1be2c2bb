#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/mesh_adjacency.h"

namespace viscera {

/// Pieces of a surface that are flat enough to be laid on a plane.
struct MeshCharts {
    std::vector<std::uint32_t> chart_of;  ///< per triangle
    std::vector<glm::dvec3> axis;         ///< per chart: the direction it is projected along, unit length
};

/// Cuts a surface into connected charts, whose triangles face their axis to within about 65 degrees and do
/// not cover each other when projected along it. Clusters of normals (Cohen-Steiner, Alliez and Desbrun,
/// "Variational shape approximation", SIGGRAPH 2004) under a bound for the angle.
[[nodiscard]] MeshCharts cut_into_charts(std::span<const glm::vec3> positions,
                                         std::span<const std::uint32_t> indices,
                                         std::span<const std::uint32_t> place,
                                         const MeshAdjacency& adjacency);

}  // namespace viscera

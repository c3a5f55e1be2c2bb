#pragma once

#include <cstdint>
#include <span>

#include <glm/glm.hpp>

#include "engine/core/mesh_adjacency.h"

namespace viscera::tissue {

/// A point on a triangle: at the weights (1 - b1 - b2, b1, b2) of its corners.
struct SurfacePoint {
    std::uint32_t triangle = 0;
    double b1 = 0.0;
    double b2 = 0.0;
};

/// Follows straight lines over a surface, as if its triangles were unfolded into one plane.
class SurfaceWalk {
  public:
    SurfaceWalk(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                const MeshAdjacency& adjacency)
        : positions_(positions), indices_(indices), adjacency_(adjacency) {}

    /// From the point at `along` in (0, 1) of a half-edge out of its triangle, in the direction and by the
    /// length of `way`, a vector in the triangle's plane. Ends early at an open border. False when there is
    /// nothing on the other side, or it has no area.
    [[nodiscard]] bool leave(std::uint32_t half_edge, double along, const glm::dvec3& way,
                             SurfacePoint& end) const;

  private:
    [[nodiscard]] glm::dvec3 corner(std::uint32_t half_edge) const {
        return glm::dvec3(positions_[indices_[half_edge]]);
    }
    [[nodiscard]] bool cross(std::uint32_t half_edge, glm::dvec3& way, std::uint32_t& entered) const;

    std::span<const glm::vec3> positions_;
    std::span<const std::uint32_t> indices_;
    const MeshAdjacency& adjacency_;
};

}  // namespace viscera::tissue

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/triangle_order.h"
#include "engine/gl/mesh.h"
#include "engine/runtime/surface_mesh.h"

namespace viscera::organ {

/// A pass's own copy of a surface on the GPU, for what other passes must not see: triangles in an order of
/// its own and a scalar that the host gives.
class OwnMesh {
  public:
    /// Positions, normals and texture coordinates as the surface has them now.
    void follow(const gl::Functions& gl, const SurfaceMesh& surface);
    /// Makes the scalar of this name what a_scalar is: the host's array, one value per merged vertex, or the
    /// mesh's own; 0 everywhere, and a fault, when neither has it.
    void select_scalar(const SurfaceMesh& surface, const std::string& name, const HostValues* values,
                       Log& log);
    /// Orders triangles from the farthest to the nearest along `axis`, which points away from the eye in the
    /// mesh's frame, by their centres. Exact for triangles that neither cross nor overlap in a cycle.
    void sort(const SurfaceMesh& surface, const glm::dvec3& axis);

    [[nodiscard]] const gl::Mesh& mesh() const { return *mesh_; }

  private:
    std::optional<gl::Mesh> mesh_;
    std::uint64_t shape_ = 0;
    std::uint64_t scalar_version_ = 0;
    std::vector<float> scalar_;
    std::string host_name_;  ///< of the host's array among the mesh's scalars
    TriangleOrderScratch scratch_;
    std::vector<std::uint32_t> sorted_;
};

}  // namespace viscera::organ

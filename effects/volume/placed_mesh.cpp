#include "effects/volume/placed_mesh.h"

namespace viscera::volume {

void PlacedMesh::visit(ParamVisitor& v, std::string_view file_key, std::string_view doc) {
    MeshFile::visit(v, {.file = file_key, .doc = doc, .required = false});
    v.field({.name = "mesh_placement", .doc = "Where the mesh is put; its centre is its box's."}, placement);
}

MeshData PlacedMesh::in_local(const glm::dmat4& local_to_world, Log& log) const {
    MeshData mesh = load_merged(log);
    const Bounds bounds = mesh.bounds();
    const glm::dmat4 to_local =
        glm::inverse(local_to_world) * placement_matrix(placement, 0.5 * glm::dvec3(bounds.min + bounds.max));
    for (glm::vec3& position : mesh.positions) {
        position = to_local * glm::dvec4(position, 1.0);
    }
    return mesh;
}

}  // namespace viscera::volume

#include "effects/organ/own_mesh.h"

#include <cmath>

namespace viscera::organ {

void OwnMesh::follow(const gl::Functions& gl, const SurfaceMesh& surface) {
    if (!mesh_) {
        mesh_.emplace(gl, surface.data());
        mesh_->update_picture_uvs(surface.picture_uvs());
    } else if (shape_ != surface.shape_key()) {
        mesh_->update_positions(surface.data().positions);
        mesh_->update_normals(surface.data().normals);
    }
    shape_ = surface.shape_key();
}

void OwnMesh::select_scalar(const SurfaceMesh& surface, const std::string& name, const HostValues* values,
                            Log& log) {
    const HostValues::Entry* given = values == nullptr ? nullptr : values->find(name);
    if (given != nullptr && given->values.size() != surface.merged_vertex_count()) {
        log.fault("organ.cut_count", "host values '" + name + "' have " +
                                         std::to_string(given->values.size()) + " entries for " +
                                         std::to_string(surface.merged_vertex_count()) +
                                         " vertices; they are left out");
        given = nullptr;
    }
    if (given == nullptr) {
        if (!mesh_->select_scalar(name)) {
            log.fault("organ.cut_scalar", "neither mesh nor host have the scalar '" + name + "': no cuts");
        }
        return;
    }
    if (scalar_version_ != given->version) {
        scalar_version_ = given->version;
        host_name_ = "host " + name;
        scalar_.resize(surface.data().positions.size());
        for (std::size_t v = 0; v < scalar_.size(); ++v) {
            scalar_[v] = given->values[surface.merged_vertex(static_cast<std::uint32_t>(v))];
        }
        mesh_->update_scalars(host_name_, scalar_);
    }
    mesh_->select_scalar(host_name_);
}

void OwnMesh::sort(const SurfaceMesh& surface, const glm::dvec3& axis) {
    const MeshData& data = surface.data();
    const std::size_t triangles = data.triangle_count();
    scratch_.keys.resize(triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        glm::dvec3 sum(0.0);
        for (std::size_t k = 0; k < 3; ++k) {
            sum += glm::dvec3(data.positions[data.indices[3 * t + k]]);
        }
        scratch_.keys[t] = float_order_key(static_cast<float>(-glm::dot(sum, axis)));
    }
    triangle_order(data.indices, scratch_, sorted_);
    mesh_->update_indices(sorted_);
}

double mm_per_uv(const MeshData& mesh, std::span<const glm::vec2> uvs) {
    double surface = 0.0;
    double texture = 0.0;
    for (std::size_t t = 0; t + 2 < mesh.indices.size() && !uvs.empty(); t += 3) {
        const std::uint32_t a = mesh.indices[t];
        const std::uint32_t b = mesh.indices[t + 1];
        const std::uint32_t c = mesh.indices[t + 2];
        const glm::dvec2 u = glm::dvec2(uvs[b]) - glm::dvec2(uvs[a]);
        const glm::dvec2 v = glm::dvec2(uvs[c]) - glm::dvec2(uvs[a]);
        const double area = std::abs(u.x * v.y - u.y * v.x);
        const double size =
            glm::length(glm::cross(glm::dvec3(mesh.positions[b]) - glm::dvec3(mesh.positions[a]),
                                   glm::dvec3(mesh.positions[c]) - glm::dvec3(mesh.positions[a])));
        // A triangle without a place in the texture says nothing of the scale of the others.
        if (area > 0.0 && std::isfinite(area)) {
            texture += area;
            surface += size;
        }
    }
    return texture > 0.0 && std::isfinite(surface) ? std::sqrt(surface / texture) : 0.0;
}

}  // namespace viscera::organ

#include "effects/organ/own_mesh.h"

#include <algorithm>
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
        const auto faulty = std::ranges::count_if(scalar_, [](float value) { return !std::isfinite(value); });
        if (faulty > 0) {
            log.fault("organ.cut_value", "host values '" + name + "' are not finite; there is no cut there",
                      static_cast<std::uint64_t>(faulty));
            std::ranges::replace_if(
                scalar_, [](float value) { return !std::isfinite(value); }, 0.0F);
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

}  // namespace viscera::organ

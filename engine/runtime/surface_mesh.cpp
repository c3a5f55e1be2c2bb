#include "engine/runtime/surface_mesh.h"

#include <algorithm>
#include <cmath>

#include "engine/core/hash.h"
#include "engine/core/log.h"
#include "engine/io/mesh.h"
#include "engine/runtime/assets.h"

namespace viscera {
namespace {

// Squares of such places are still floats.
constexpr float farthest_mm = 1e15F;

std::uint64_t content_key(const MeshData& mesh) {
    Hash hash;
    hash.bytes(std::as_bytes(std::span(mesh.positions)));
    hash.bytes(std::as_bytes(std::span(mesh.normals)));
    hash.bytes(std::as_bytes(std::span(mesh.uvs)));
    hash.bytes(std::as_bytes(std::span(mesh.indices)));
    return hash.value();
}

/// Sums of the triangles' normals weighted by area, one per place, made unit vectors. A place whose triangles
/// cancel out keeps 0.
void smooth_normals(const MeshData& mesh, std::span<const std::uint32_t> place,
                    std::span<glm::vec3> normals) {
    std::ranges::fill(normals, glm::vec3(0.0F));
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const glm::vec3& p = mesh.positions[mesh.indices[t]];
        const glm::vec3 normal =
            glm::cross(mesh.positions[mesh.indices[t + 1]] - p, mesh.positions[mesh.indices[t + 2]] - p);
        for (std::size_t k = 0; k < 3; ++k) {
            normals[place[mesh.indices[t + k]]] += normal;
        }
    }
    for (glm::vec3& normal : normals) {
        const glm::dvec3 sum(normal);
        const double length = glm::length(sum);
        normal = length > 0.0 && std::isfinite(length) ? glm::vec3(sum / length) : glm::vec3(0.0F);
    }
}

/// `normal` turned as `from` turns to `to` (unit vectors) by the shortest way.
glm::vec3 turned(const glm::vec3& normal, const glm::vec3& from, const glm::vec3& to) {
    const glm::vec3 axis = glm::cross(from, to);
    const float cosine = glm::dot(from, to);
    constexpr float nearly_opposite = -0.999F;
    if (cosine < nearly_opposite) {
        return to;
    }
    const glm::vec3 result =
        cosine * normal + glm::cross(axis, normal) + axis * (glm::dot(axis, normal) / (1.0F + cosine));
    const float length = glm::length(result);
    return length > 0.0F ? result / length : normal;
}

}  // namespace

void SurfaceMeshParams::visit(ParamVisitor& v) {
    MeshFile::visit(v, {.file = "file", .filter = "filter"});
    v.field({.name = "placement", .doc = "Where the mesh is put; its centre is its box's."}, placement);
    v.field({.name = "host_positions",
             .doc = "Name of the host's array of 3 floats [mm] per vertex that moves them; empty: none."},
            host_positions);
    v.field({.name = "atlas",
             .doc = "Whose texture coordinates it is painted by: the file's, made ones, or the file's where "
                    "each place has its own and else made ones."},
            atlas);
}

SurfaceMesh::SurfaceMesh(TextureSpace space)
    : data_(std::move(space.mesh)),
      picture_uvs_(std::move(space.picture_uvs)),
      origin_(std::move(space.origin)),
      place_(io::first_at_same_place(data_.positions)),
      bounds_(data_.bounds()),
      merged_count_(data_.positions.size() - origin_.size()),
      key_(content_key(data_)),
      shape_key_(key_) {
    if (!bounds_.empty()) {
        centre_ = 0.5 * (glm::dvec3(bounds_.min) + glm::dvec3(bounds_.max));
    }
}

std::shared_ptr<SurfaceMesh> SurfaceMesh::load(Assets& assets, const SurfaceMeshParams& params) {
    const std::uint64_t key =
        Hash().add(params.MeshFile::key(assets)).add(params.host_positions).add(params.atlas).value();
    return assets.shared<SurfaceMesh>(key, [&] {
        return std::make_shared<SurfaceMesh>(
            make_texture_space(params.load(assets.log()), params.atlas, params.file.path.string(), assets));
    });
}

void SurfaceMesh::move(const HostValues* values, std::string_view name, Log& log) {
    const HostValues::Entry* given = values == nullptr || name.empty() ? nullptr : values->find(name);
    const std::uint64_t version = given == nullptr ? 0 : given->version;
    if (version == host_version_) {
        return;
    }
    host_version_ = version;
    if (given != nullptr && given->values.size() != 3 * merged_count_) {
        log.fault("surface.host_position_count",
                  "host values '" + std::string(name) + "' have " + std::to_string(given->values.size()) +
                      " entries, not 3 for each of " + std::to_string(merged_count_) +
                      " vertices; the file's positions stay");
        given = nullptr;
    }
    if (given != nullptr &&
        !std::ranges::all_of(given->values, [](float value) { return std::abs(value) < farthest_mm; })) {
        log.fault("surface.host_position_not_finite",
                  "host values '" + std::string(name) +
                      "' are not all finite and below 1e15 mm; the file's positions stay");
        given = nullptr;
    }
    if (given != nullptr) {
        set_positions(given->values);
        shape_key_ = Hash().add(key_).add(version).value();
    } else if (shape_key_ != key_) {
        data_.positions = file_positions_;
        data_.normals = file_normals_;
        shape_key_ = key_;
        bounds_ = data_.bounds();
    }
}

void SurfaceMesh::set_positions(std::span<const float> xyz) {
    if (file_positions_.empty()) {
        file_positions_ = data_.positions;
        file_normals_ = data_.normals;
        smooth_normals_.resize(file_positions_.size());
        smooth_normals(data_, place_, smooth_normals_);
        file_smooth_normals_ = smooth_normals_;
    }
    for (std::size_t v = 0; v < merged_count_; ++v) {
        data_.positions[v] = {xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2]};
    }
    for (std::size_t i = 0; i < origin_.size(); ++i) {
        data_.positions[merged_count_ + i] = data_.positions[origin_[i]];
    }
    bounds_ = data_.bounds();
    turn_normals();
}

void SurfaceMesh::turn_normals() {
    smooth_normals(data_, place_, smooth_normals_);
    for (std::size_t v = 0; v < data_.normals.size(); ++v) {
        const glm::vec3& from = file_smooth_normals_[place_[v]];
        const glm::vec3& to = smooth_normals_[place_[v]];
        const bool known = from != glm::vec3(0.0F) && to != glm::vec3(0.0F);
        data_.normals[v] = known ? turned(file_normals_[v], from, to) : file_normals_[v];
    }
}

const gl::Mesh& SurfaceMesh::gpu(const gl::Functions& gl) {
    if (!gpu_) {
        gpu_ = std::make_unique<gl::Mesh>(gl, data_);
        gpu_->update_picture_uvs(picture_uvs_);
    } else if (gpu_shape_ != shape_key_) {
        gpu_->update_positions(data_.positions);
        gpu_->update_normals(data_.normals);
    }
    gpu_shape_ = shape_key_;
    return *gpu_;
}

}  // namespace viscera

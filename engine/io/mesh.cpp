#include "engine/io/mesh.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <new>
#include <unordered_map>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/mesh_readers.h"

namespace viscera::io {

namespace {

struct Format {
    std::string_view extension;
    std::vector<RawMesh> (*read)(const std::filesystem::path&, Log&);
    double mm_per_unit;
};

constexpr std::array<Format, 6> formats{{{".gltf", read_gltf, 1000.0},
                                         {".glb", read_gltf, 1000.0},
                                         {".stl", read_stl, 1.0},
                                         {".obj", read_obj, 1.0},
                                         {".ply", read_ply, 1.0},
                                         {".vtp", read_vtp_mesh, 1.0}}};

const Format& format_of(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    const auto* const found = std::ranges::find(formats, extension, &Format::extension);
    if (found == formats.end()) {
        throw Error(ErrorCode::file, file.string(),
                    "is no mesh that can be read: .gltf, .glb, .stl, .obj, .ply and .vtp can");
    }
    return *found;
}

void filter_by_name(std::vector<RawMesh>& meshes, const std::string& filter,
                    const std::filesystem::path& file) {
    constexpr std::size_t most_listed = 20;
    std::string names;
    for (std::size_t i = 0; i < std::min(meshes.size(), most_listed); ++i) {
        names += (i == 0 ? "'" : ", '") + meshes[i].mesh.name + "'";
    }
    const bool more = meshes.size() > most_listed;
    std::erase_if(meshes, [&](const RawMesh& raw) {
        return raw.mesh.name.find(filter) == std::string::npos &&
               raw.second_name.find(filter) == std::string::npos;
    });
    if (meshes.empty()) {
        throw Error(ErrorCode::file, file.string(),
                    "no mesh has '" + filter + "' in its name; there are " + names + (more ? ", ..." : ""));
    }
}

glm::dvec3 unit(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : glm::dvec3(0.0);
}

}  // namespace

std::vector<MeshData> load_meshes(const std::filesystem::path& file, const MeshOptions& options, Log& log) {
    const Format& format = format_of(file);
    const double scale = options.scale_mm_per_unit.value_or(format.mm_per_unit);
    if (!std::isfinite(scale) || scale <= 0.0) {
        throw Error(ErrorCode::usage, file.string(), "the scale in mm per unit must be finite and above 0");
    }
    try {
        std::vector<RawMesh> raw = format.read(file, log);
        if (!options.name_filter.empty()) {
            filter_by_name(raw, options.name_filter, file);
        }
        std::vector<MeshData> meshes;
        meshes.reserve(raw.size());
        for (RawMesh& one : raw) {
            const std::string where = file.string() + ": mesh '" + one.mesh.name + "'";
            meshes.push_back(clean(std::move(one), scale, where, log));
        }
        if (meshes.empty()) {
            log.fault("mesh: without triangles", file.string() + ": holds no mesh");
        }
        return meshes;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::limit, file.string(), "no memory for its meshes");
    }
}

std::vector<glm::vec3> vertex_normals(const MeshData& mesh) {
    std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
    std::vector<glm::dvec3> first(mesh.positions.size(), glm::dvec3(0.0));
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        std::array<glm::dvec3, 3> corner;
        for (std::size_t k = 0; k < 3; ++k) {
            corner[k] = glm::dvec3(mesh.positions[mesh.indices[t + k]]);
        }
        const glm::dvec3 normal = unit(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 u = unit(corner[(k + 1) % 3] - corner[k]);
            const glm::dvec3 v = unit(corner[(k + 2) % 3] - corner[k]);
            const double angle = std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
            sums[mesh.indices[t + k]] += angle * normal;
            if (first[mesh.indices[t + k]] == glm::dvec3(0.0)) {
                first[mesh.indices[t + k]] = normal;
            }
        }
    }
    std::vector<glm::vec3> normals(mesh.positions.size());
    for (std::size_t v = 0; v < normals.size(); ++v) {
        // Triangles back to back cancel out: then the first one's normal stands.
        constexpr double cancelled = 1e-9;
        const glm::dvec3 normal = glm::length(sums[v]) > cancelled ? unit(sums[v]) : first[v];
        normals[v] = normal == glm::dvec3(0.0) ? glm::vec3(0.0F, 0.0F, 1.0F) : glm::vec3(normal);
    }
    return normals;
}

namespace {

/// A number whose last place is that of the largest coordinate: what is added to it and taken away again is
/// rounded to that.
float rounder(std::span<const glm::vec3> positions) {
    float largest = 0.0F;
    for (const glm::vec3& p : positions) {
        const float here = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        largest = std::isfinite(here) ? std::max(largest, here) : largest;
    }
    const float number = 1.5F * std::exp2(std::ceil(std::log2(largest)));
    return std::isfinite(number) ? number : 0.0F;
}

}  // namespace

std::vector<std::uint32_t> first_at_same_place(std::span<const glm::vec3> positions) {
    const float large = rounder(positions);
    using Key = std::array<std::uint32_t, 3>;
    struct Hash {
        std::size_t operator()(const Key& key) const {
            std::uint64_t hash = 0;
            for (const std::uint32_t word : key) {
                hash = (hash ^ word) * 0x9E3779B97F4A7C15U;
                hash ^= hash >> 32U;
            }
            return hash;
        }
    };
    std::unordered_map<Key, std::uint32_t, Hash> first;
    first.reserve(positions.size());
    std::vector<std::uint32_t> result(positions.size());
    for (std::size_t v = 0; v < positions.size(); ++v) {
        Key key{};
        for (int c = 0; c < 3; ++c) {
            const float value = (positions[v][c] + large) - large;
            key[static_cast<std::size_t>(c)] = std::bit_cast<std::uint32_t>(value == 0.0F ? 0.0F : value);
        }
        result[v] = first.try_emplace(key, static_cast<std::uint32_t>(v)).first->second;
    }
    return result;
}

MeshData concatenate(std::span<const MeshData> meshes) {
    constexpr std::uint32_t out_of_range = std::numeric_limits<std::uint32_t>::max();
    MeshData merged;
    if (meshes.empty()) {
        return merged;
    }
    merged.name = meshes.front().name;
    bool any_uvs = false;
    bool all_normals = true;
    for (const MeshData& mesh : meshes) {
        any_uvs = any_uvs || !mesh.uvs.empty();
        all_normals = all_normals && mesh.normals.size() == mesh.positions.size();
        for (const VertexScalars& scalars : mesh.scalars) {
            if (std::ranges::find(merged.scalars, scalars.name, &VertexScalars::name) ==
                merged.scalars.end()) {
                merged.scalars.push_back({scalars.name, {}});
            }
        }
    }
    for (const MeshData& mesh : meshes) {
        const std::size_t base = merged.positions.size();
        if (base + mesh.positions.size() >= out_of_range) {
            throw Error(ErrorCode::limit, merged.name, "has more vertices than 32-bit indices can name");
        }
        merged.positions.insert(merged.positions.end(), mesh.positions.begin(), mesh.positions.end());
        if (any_uvs) {
            merged.uvs.insert(merged.uvs.end(), mesh.uvs.begin(), mesh.uvs.end());
            merged.uvs.resize(merged.positions.size());
        }
        if (all_normals) {
            merged.normals.insert(merged.normals.end(), mesh.normals.begin(), mesh.normals.end());
        }
        for (const std::uint32_t index : mesh.indices) {
            merged.indices.push_back(index < mesh.positions.size() ? static_cast<std::uint32_t>(base) + index
                                                                   : out_of_range);
        }
        for (const VertexScalars& scalars : mesh.scalars) {
            auto& values = std::ranges::find(merged.scalars, scalars.name, &VertexScalars::name)->values;
            values.resize(base, 0.0F);
            values.insert(values.end(), scalars.values.begin(), scalars.values.end());
        }
    }
    for (VertexScalars& scalars : merged.scalars) {
        scalars.values.resize(merged.positions.size(), 0.0F);
    }
    return merged;
}

MeshData merge(std::span<const MeshData> meshes) {
    MeshData merged = concatenate(meshes);
    if (merged.normals.size() != merged.positions.size()) {
        merged.normals = vertex_normals(merged);
    }
    return merged;
}

}  // namespace viscera::io

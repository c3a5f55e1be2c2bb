#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "engine/core/log.h"
#include "engine/core/mesh_data.h"
#include "engine/io/mesh.h"

namespace viscera::io {

/// A mesh as a file gives it, before clean(): indices and positions may be anything.
struct RawMesh {
    MeshData mesh;  ///< in the file's own unit; every per-vertex list is empty or as long as positions
    std::string second_name;  ///< another name by which it may be asked for: the mesh of a glTF node
    bool weld = false;        ///< join vertices that agree in all they have
};

// One reader per family of formats. Each throws Error(file) for a damaged file and logs what it leaves out.
[[nodiscard]] std::vector<RawMesh> read_gltf(const std::filesystem::path& file, Log& log);
[[nodiscard]] std::vector<RawMesh> read_stl(const std::filesystem::path& file, Log& log);
[[nodiscard]] std::vector<RawMesh> read_obj(const std::filesystem::path& file, Log& log);
[[nodiscard]] std::vector<RawMesh> read_ply(const std::filesystem::path& file, Log& log);
[[nodiscard]] std::vector<RawMesh> read_vtp_mesh(const std::filesystem::path& file, Log& log);

/// Scales to mm, drops what cannot be drawn (counted under "mesh: ..."), joins vertices where asked, leaves
/// out unused ones and completes the normals. `where` names file and mesh in the log.
[[nodiscard]] MeshData clean(RawMesh raw, double scale_mm_per_unit, std::string_view where, Log& log);

/// As merge(), but for raw meshes too: an index out of range stays so, and normals stay only if every mesh
/// has them.
[[nodiscard]] MeshData concatenate(std::span<const MeshData> meshes);

/// The i-th three of a list of numbers.
[[nodiscard]] inline glm::dvec3 tuple3(std::span<const double> values, std::size_t i) {
    return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// Splits a strip of `count` vertices into triangles of one orientation; `vertex(i)` gives the i-th index.
template <class Vertex>
void append_strip(std::size_t count, const Vertex& vertex, std::vector<std::uint32_t>& indices) {
    for (std::size_t i = 2; i < count; ++i) {
        const std::size_t odd = i % 2;
        indices.insert(indices.end(), {vertex(i - 2 + odd), vertex(i - 1 - odd), vertex(i)});
    }
}

/// Splits a convex polygon, or a fan, of `count` vertices into triangles about its first vertex.
template <class Vertex>
void append_fan(std::size_t count, const Vertex& vertex, std::vector<std::uint32_t>& indices) {
    for (std::size_t i = 2; i < count; ++i) {
        indices.insert(indices.end(), {vertex(0), vertex(i - 1), vertex(i)});
    }
}

}  // namespace viscera::io

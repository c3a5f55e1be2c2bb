#include <algorithm>

#include "engine/io/mesh_readers.h"
#include "engine/io/vtp.h"

namespace viscera::io {

namespace {

/// The indices of cell i of `cells`.
std::span<const std::uint32_t> cell(const VtkCells& cells, std::size_t i) {
    const std::size_t begin = i == 0 ? 0 : cells.offsets[i - 1];
    return std::span(cells.connectivity).subspan(begin, cells.offsets[i] - begin);
}

void convert_point_data(const VtpPiece& piece, MeshData& mesh) {
    for (const VtkArray& array : piece.point_data) {
        if (array.components == 1) {
            mesh.scalars.push_back({array.name, {array.values.begin(), array.values.end()}});
        } else if (array.components == 3 && (array.name == piece.normals_name || array.name == "Normals")) {
            mesh.normals.resize(piece.points);
            for (std::size_t v = 0; v < piece.points; ++v) {
                mesh.normals[v] = glm::vec3(tuple3(array.values, v));
            }
        } else if (array.components == 2 && array.name == piece.uvs_name) {
            mesh.uvs.resize(piece.points);
            for (std::size_t v = 0; v < piece.points; ++v) {
                mesh.uvs[v] = glm::vec2(glm::dvec2(array.values[2 * v], array.values[2 * v + 1]));
            }
        }
    }
}

MeshData convert(const VtpPiece& piece) {
    MeshData mesh;
    mesh.positions.resize(piece.points);
    for (std::size_t v = 0; v < piece.points; ++v) {
        mesh.positions[v] = glm::vec3(tuple3(piece.positions, v));
    }
    convert_point_data(piece, mesh);
    for (std::size_t i = 0; i < piece.polys.offsets.size(); ++i) {
        const auto polygon = cell(piece.polys, i);
        append_fan(
            polygon.size(), [&](std::size_t k) { return polygon[k]; }, mesh.indices);
    }
    for (std::size_t i = 0; i < piece.strips.offsets.size(); ++i) {
        const auto strip = cell(piece.strips, i);
        append_strip(
            strip.size(), [&](std::size_t k) { return strip[k]; }, mesh.indices);
    }
    return mesh;
}

}  // namespace

std::vector<RawMesh> read_vtp_mesh(const std::filesystem::path& file, Log&) {
    std::vector<RawMesh> meshes;
    for (const VtpPiece& piece : read_vtp(file)) {
        meshes.push_back({convert(piece), "", false});
        std::string& name = meshes.back().mesh.name;
        name = file.stem().string() + (meshes.size() > 1 ? "." + std::to_string(meshes.size() - 1) : "");
    }
    return meshes;
}

}  // namespace viscera::io

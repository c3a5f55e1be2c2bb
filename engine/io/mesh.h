#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/mesh_data.h"

namespace viscera::io {

struct MeshOptions {
    std::optional<double> scale_mm_per_unit{};  ///< > 0; none: 1000 for glTF (metres), 1 for all others
    std::string name_filter{};  ///< only meshes or glTF nodes whose name contains this; empty: all
};

/// Reads a surface mesh: .gltf, .glb, .stl, .obj, .ply or .vtp. Positions come in mm in the file's own axes,
/// with node transforms applied; polygons (taken as convex) and strips are split into triangles; STL vertices
/// at one place are joined. Normals that the file does not give (or gives as zero) are computed. A glTF node
/// or a solid of an STL text is one mesh; `_NAME` attributes of glTF, the point data of VTP and further
/// vertex properties of PLY come as VertexScalars. glTF's skins and morph targets are left out, and the log
/// says so.
/// Triangles that are degenerate, out of range or not finite are counted with Log::fault and dropped,
/// vertices that no triangle uses are left out; a mesh in which nothing is left is returned without triangles
/// and the log says so. Throws Error(file) for a damaged or unknown file or where no name holds the filter,
/// Error(usage) for a bad scale, Error(limit) for more vertices than 32-bit indices or the memory can hold.
[[nodiscard]] std::vector<MeshData> load_meshes(const std::filesystem::path& file, const MeshOptions& options,
                                                Log& log);

/// All meshes as one, in their order, with the first one's name. Where some have texture coordinates, the
/// others get (0, 0); normals are computed where some mesh lacks them; a scalar that a mesh lacks is 0 there.
[[nodiscard]] MeshData merge(std::span<const MeshData> meshes);

/// Unit vertex normals, the mean of the triangles' weighted by their angle at the vertex.
[[nodiscard]] std::vector<glm::vec3> vertex_normals(const MeshData& mesh);

/// For each vertex the first vertex at the same place: seams of texture or normals closed. Coordinates are
/// compared in steps of the largest one's last place, since what is 0 often comes as 1e-15.
[[nodiscard]] std::vector<std::uint32_t> first_at_same_place(std::span<const glm::vec3> positions);

/// Reads a centreline: the lines of a .vtp with point data `MaximumInscribedSphereRadius` or `radius`, or
/// .json: {"unit": "mm", "nodes": [[x, y, z, radius], ...], "edges": [[a, b], ...]}. Points of a .vtp at one
/// place become one node, since branches repeat their trunk. Nodes and edges that are not finite, doubled or
/// out of range are counted and dropped, a negative radius becomes 0. Throws Error(file) naming file and key.
[[nodiscard]] CentrelineGraph load_centreline(const std::filesystem::path& file, Log& log);

}  // namespace viscera::io

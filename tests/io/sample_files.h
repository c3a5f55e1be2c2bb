#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/mesh_data.h"

namespace viscera::test {

/// The little-endian bytes of a value.
template <class T>
std::string bytes_of(T value) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    return bytes;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
    std::string bytes;
    for (const T value : values) {
        bytes += bytes_of(value);
    }
    return bytes;
}

inline std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            bits = (bits << 8U) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text.push_back(i + k <= bytes.size() ? digits[(bits >> (18U - 6U * k)) & 63U] : '=');
        }
    }
    return text;
}

/// A .glb of the given JSON and binary chunk.
inline std::string glb(std::string json, std::string binary) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    const auto chunk = [](const std::string& data, std::uint32_t type) {
        return bytes_of(static_cast<std::uint32_t>(data.size())) + bytes_of(type) + data;
    };
    const std::string chunks = chunk(json, 0x4E4F534A) + (binary.empty() ? "" : chunk(binary, 0x004E4942));
    return "glTF" + bytes_of(std::uint32_t{2}) + bytes_of(static_cast<std::uint32_t>(12 + chunks.size())) +
           chunks;
}

/// Corners and faces of a tetrahedron, counter-clockwise seen from outside.
inline const std::vector<float> tetra_points{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
inline const std::vector<std::uint16_t> tetra_faces{0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};

/// Positions (48 bytes), indices (24 bytes), one float per vertex (16 bytes): the binary chunk of tetra_json.
inline std::string tetra_binary() {
    return bytes_of(tetra_points) + bytes_of(tetra_faces) +
           bytes_of(std::vector<float>{0.25F, 0.5F, 0.75F, 1.0F});
}

inline std::string tetra_json(std::string_view buffer_extra = "", std::string_view node_extra = "") {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"node","mesh":0)" +
           std::string(node_extra) +
           R"(}],"meshes":[{"name":"tetra","primitives":[{"attributes":{"POSITION":0,"_DENSITY":2},"indices":1}]}],)"
           R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
           R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"},)"
           R"({"bufferView":2,"componentType":5126,"count":4,"type":"SCALAR"}],)"
           R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24},)"
           R"({"buffer":0,"byteOffset":72,"byteLength":16}],"buffers":[{"byteLength":88)" +
           std::string(buffer_extra) + "}]}";
}

inline std::string tetra_glb() {
    return glb(tetra_json(), tetra_binary());
}

inline std::string tetra_stl() {
    std::string bytes(80, ' ');
    bytes += bytes_of(std::uint32_t{4});
    for (std::size_t i = 0; i < tetra_faces.size(); i += 3) {
        bytes += std::string(12, '\0');
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t c = 0; c < 3; ++c) {
                bytes += bytes_of(tetra_points[3 * std::size_t{tetra_faces[i + k]} + c]);
            }
        }
        bytes += std::string(2, '\0');
    }
    return bytes;
}

/// Triples of numbers, one a line, each line begun by `prefix`.
template <class T>
std::string triples(const std::vector<T>& values, const std::string& prefix, int plus = 0) {
    std::string text;
    for (std::size_t i = 0; i < values.size(); i += 3) {
        text += prefix;
        for (std::size_t k = 0; k < 3; ++k) {
            text += (k == 0 ? "" : " ") + std::to_string(static_cast<int>(values[i + k]) + plus);
        }
        text += "\n";
    }
    return text;
}

inline std::string tetra_stl_text() {
    std::string text = "solid tetra\n";
    for (std::size_t i = 0; i < tetra_faces.size(); i += 3) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (std::size_t k = 0; k < 3; ++k) {
            const auto first = tetra_points.begin() + 3 * tetra_faces[i + k];
            text += triples(std::vector<float>(first, first + 3), "vertex ");
        }
        text += "endloop\nendfacet\n";
    }
    return text + "endsolid tetra\n";
}

inline std::string tetra_obj() {
    return "mtllib no.mtl\no tetra\n" + triples(tetra_points, "v ") + triples(tetra_faces, "f ", 1);
}

inline std::string tetra_ply() {
    return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 4\nproperty list uchar int vertex_indices\nend_header\n" +
           triples(tetra_points, "") + triples(tetra_faces, "3 ");
}

inline std::string tetra_ply_binary() {
    std::string bytes =
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float "
        "y\nproperty "
        "float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n" +
        bytes_of(tetra_points);
    for (std::size_t i = 0; i < tetra_faces.size(); i += 3) {
        bytes += bytes_of(std::uint8_t{3});
        for (std::size_t k = 0; k < 3; ++k) {
            bytes += bytes_of(std::int32_t{tetra_faces[i + k]});
        }
    }
    return bytes;
}

/// A PolyData file with the given inside of its one piece and, after it, appended data.
inline std::string vtp(std::string_view counts, std::string_view inside, std::string_view attributes = "",
                       std::string_view appended = "") {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" " + std::string(attributes) +
           "><PolyData><Piece " + std::string(counts) + ">" + std::string(inside) + "</Piece></PolyData>" +
           std::string(appended) + "</VTKFile>\n";
}

inline std::string tetra_vtp() {
    return vtp(
        R"(NumberOfPoints="4" NumberOfPolys="4")",
        R"(<PointData><DataArray type="Float32" Name="density" format="ascii">0.25 0.5 0.75 1</DataArray>)"
        R"(</PointData><Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">)"
        "0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Polys>"
        R"(<DataArray type="Int64" Name="connectivity" format="ascii">0 2 1 0 1 3 1 2 3 2 0 3</DataArray>)"
        R"(<DataArray type="Int64" Name="offsets" format="ascii">3 6 9 12</DataArray></Polys>)");
}

/// What load_meshes() promises of every mesh.
inline void expect_valid(const MeshData& mesh) {
    const std::size_t count = mesh.positions.size();
    ASSERT_EQ(mesh.indices.size() % 3, 0U);
    for (const std::uint32_t index : mesh.indices) {
        ASSERT_LT(index, count);
    }
    for (const glm::vec3& p : mesh.positions) {
        ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    }
    ASSERT_EQ(mesh.normals.size(), count);
    for (const glm::vec3& n : mesh.normals) {
        ASSERT_NEAR(glm::length(n), 1.0F, 1e-5F);
    }
    ASSERT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == count);
    for (const VertexScalars& scalars : mesh.scalars) {
        ASSERT_EQ(scalars.values.size(), count);
        for (const float value : scalars.values) {
            ASSERT_TRUE(std::isfinite(value));
        }
    }
}

/// Volume enclosed, positive where triangles run counter-clockwise seen from outside.
inline double volume_of(const MeshData& mesh) {
    double volume = 0.0;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[t]]);
        const glm::dvec3 b(mesh.positions[mesh.indices[t + 1]]);
        const glm::dvec3 c(mesh.positions[mesh.indices[t + 2]]);
        volume += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    return volume;
}

}  // namespace viscera::test

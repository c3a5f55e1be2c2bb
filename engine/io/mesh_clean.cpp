#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <string>
#include <unordered_map>

#include "engine/core/error.h"
#include "engine/core/finite.h"
#include "engine/io/mesh_readers.h"

namespace viscera::io {

namespace {

constexpr std::uint32_t dropped_vertex = std::numeric_limits<std::uint32_t>::max();

void count(Log& log, std::string_view where, const std::string& what, std::size_t number) {
    if (number > 0) {
        log.fault("mesh: " + what, std::string(where) + ": " + std::to_string(number) + " " + what, number);
    }
}

void scale_positions(MeshData& mesh, double scale_mm_per_unit) {
    for (glm::vec3& p : mesh.positions) {
        p = glm::vec3(glm::dvec3(p) * scale_mm_per_unit);
    }
}

/// All that vertex `v` has, as text that is equal only where every bit is (0 and -0 taken as one).
void append_key(const MeshData& mesh, std::size_t v, std::string& key) {
    const auto append = [&](float value) {
        const auto bits = std::bit_cast<std::array<char, sizeof(float)>>(value == 0.0F ? 0.0F : value);
        key.append(bits.data(), bits.size());
    };
    for (int c = 0; c < 3; ++c) {
        append(mesh.positions[v][c]);
        if (!mesh.normals.empty()) {
            append(mesh.normals[v][c]);
        }
        if (!mesh.uvs.empty() && c < 2) {
            append(mesh.uvs[v][c]);
        }
    }
    for (const VertexScalars& scalars : mesh.scalars) {
        append(scalars.values[v]);
    }
}

void weld(MeshData& mesh) {
    std::unordered_map<std::string, std::uint32_t> first;
    first.reserve(mesh.positions.size());
    std::vector<std::uint32_t> target(mesh.positions.size());
    std::string key;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        key.clear();
        append_key(mesh, v, key);
        target[v] = first.try_emplace(key, static_cast<std::uint32_t>(v)).first->second;
    }
    for (std::uint32_t& index : mesh.indices) {
        if (index < target.size()) {
            index = target[index];
        }
    }
}

/// Without area, also where rounding has left some: with two corners at one place.
bool degenerate(const MeshData& mesh, std::span<const std::uint32_t> place, std::uint32_t a, std::uint32_t b,
                std::uint32_t c) {
    if (place[a] == place[b] || place[b] == place[c] || place[c] == place[a]) {
        return true;
    }
    const glm::dvec3 p(mesh.positions[a]);
    const glm::dvec3 normal =
        glm::cross(glm::dvec3(mesh.positions[b]) - p, glm::dvec3(mesh.positions[c]) - p);
    return normal == glm::dvec3(0.0);
}

void drop_triangles(MeshData& mesh, std::string_view where, Log& log) {
    std::size_t out_of_range = 0;
    std::size_t not_finite = 0;
    std::size_t without_area = 0;
    const std::vector<std::uint32_t> place = first_at_same_place(mesh.positions);
    std::vector<std::uint32_t> kept;
    kept.reserve(mesh.indices.size());
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const std::uint32_t a = mesh.indices[t];
        const std::uint32_t b = mesh.indices[t + 1];
        const std::uint32_t c = mesh.indices[t + 2];
        if (std::max({a, b, c}) >= mesh.positions.size()) {
            ++out_of_range;
        } else if (!finite(mesh.positions[a]) || !finite(mesh.positions[b]) || !finite(mesh.positions[c])) {
            ++not_finite;
        } else if (degenerate(mesh, place, a, b, c)) {
            ++without_area;
        } else {
            kept.insert(kept.end(), {a, b, c});
        }
    }
    count(log, where, "triangles with an index out of range dropped", out_of_range);
    count(log, where, "triangles with a vertex that is not finite dropped", not_finite);
    count(log, where, "triangles without area dropped", without_area);
    mesh.indices = std::move(kept);
}

/// Those of the same corners in the same order of winding: they would be drawn twice, and no edge of theirs
/// would be one between two triangles.
void drop_doubled(MeshData& mesh, std::string_view where, Log& log) {
    using Triangle = std::array<std::uint32_t, 3>;
    std::vector<std::pair<Triangle, std::size_t>> triangles;  // the smallest corner first, and which it is
    triangles.reserve(mesh.triangle_count());
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto corner = mesh.indices.begin() + static_cast<std::ptrdiff_t>(3 * t);
        Triangle triangle{corner[0], corner[1], corner[2]};
        std::rotate(triangle.begin(), std::ranges::min_element(triangle), triangle.end());
        triangles.emplace_back(triangle, t);
    }
    std::ranges::sort(triangles);
    std::vector<char> doubled(triangles.size(), 0);
    for (std::size_t i = 1; i < triangles.size(); ++i) {
        doubled[triangles[i].second] = triangles[i].first == triangles[i - 1].first ? 1 : 0;
    }
    const auto number = static_cast<std::size_t>(std::ranges::count(doubled, 1));
    if (number == 0) {
        return;
    }
    count(log, where, "triangles that are there twice dropped", number);
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        if (doubled[i / 3] == 0) {
            kept.push_back(mesh.indices[i]);
        }
    }
    mesh.indices = std::move(kept);
}

template <class T>
void keep(std::vector<T>& values, const std::vector<std::uint32_t>& new_index, std::size_t left) {
    if (values.empty()) {
        return;
    }
    std::vector<T> kept(left);
    for (std::size_t v = 0; v < values.size(); ++v) {
        if (new_index[v] != dropped_vertex) {
            kept[new_index[v]] = values[v];
        }
    }
    values = std::move(kept);
}

void drop_unused_vertices(MeshData& mesh) {
    std::vector<std::uint32_t> new_index(mesh.positions.size(), dropped_vertex);
    for (const std::uint32_t index : mesh.indices) {
        new_index[index] = 0;
    }
    std::uint32_t left = 0;
    for (std::uint32_t& index : new_index) {
        index = index == dropped_vertex ? dropped_vertex : left++;
    }
    for (std::uint32_t& index : mesh.indices) {
        index = new_index[index];
    }
    keep(mesh.positions, new_index, left);
    keep(mesh.normals, new_index, left);
    keep(mesh.uvs, new_index, left);
    for (VertexScalars& scalars : mesh.scalars) {
        keep(scalars.values, new_index, left);
    }
}

void repair_attributes(MeshData& mesh, std::string_view where, Log& log) {
    std::size_t bad_uvs = 0;
    for (glm::vec2& uv : mesh.uvs) {
        if (!finite(uv)) {
            uv = glm::vec2(0.0F);
            ++bad_uvs;
        }
    }
    std::size_t bad_scalars = 0;
    for (VertexScalars& scalars : mesh.scalars) {
        for (float& value : scalars.values) {
            if (!finite(value)) {
                value = 0.0F;
                ++bad_scalars;
            }
        }
    }
    count(log, where, "texture coordinates that are not finite set to 0", bad_uvs);
    count(log, where, "scalars that are not finite set to 0", bad_scalars);
}

void complete_normals(MeshData& mesh, std::string_view where, Log& log) {
    if (mesh.normals.empty()) {
        log.info(std::string(where) + ": has no normals; they are made from its triangles");
        mesh.normals = vertex_normals(mesh);
        return;
    }
    std::vector<glm::vec3> computed;
    std::size_t replaced = 0;
    for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
        const glm::dvec3 normal(mesh.normals[v]);
        const double length = glm::length(normal);
        if (finite(length) && length > 0.0) {
            mesh.normals[v] = glm::vec3(normal / length);
            continue;
        }
        if (computed.empty()) {
            computed = vertex_normals(mesh);
        }
        mesh.normals[v] = computed[v];
        ++replaced;
    }
    count(log, where, "normals that are zero or not finite computed anew", replaced);
}

}  // namespace

MeshData clean(RawMesh raw, double scale_mm_per_unit, std::string_view where, Log& log) {
    MeshData mesh = std::move(raw.mesh);
    if (mesh.positions.size() >= dropped_vertex) {
        throw Error(ErrorCode::limit, std::string(where), "has more vertices than 32-bit indices can name");
    }
    scale_positions(mesh, scale_mm_per_unit);
    if (raw.weld) {
        weld(mesh);
    }
    drop_triangles(mesh, where, log);
    drop_doubled(mesh, where, log);
    drop_unused_vertices(mesh);
    repair_attributes(mesh, where, log);
    complete_normals(mesh, where, log);
    if (mesh.indices.empty()) {
        log.fault("mesh: without triangles", std::string(where) + ": no triangle is left");
    }
    return mesh;
}

}  // namespace viscera::io

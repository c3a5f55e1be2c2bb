#include "assets/generate/vessel_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "assets/generate/isosurface.h"
#include "assets/generate/vessel_field.h"

namespace viscera::assets {
namespace {

/// Moves each vertex towards the middle of its neighbours, within the wall.
void spread_vertices(QuadMesh& mesh, const VesselField& field) {
    std::vector<glm::dvec3> sums(mesh.vertices.size(), glm::dvec3(0.0));
    std::vector<double> counts(mesh.vertices.size(), 0.0);
    for (const auto& quad : mesh.quads) {
        for (std::size_t k = 0; k < 4; ++k) {
            sums[quad[k]] += mesh.vertices[quad[(k + 1) % 4]];
            counts[quad[k]] += 1.0;
        }
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const glm::dvec3 p = mesh.vertices[i];
        const glm::dvec3 normal = field.gradient(p);
        const glm::dvec3 step = 0.6 * (sums[i] / counts[i] - p);
        mesh.vertices[i] = field.onto_wall(p + step - normal * glm::dot(step, normal));
    }
}

/// Two triangles per quad, cut along its shorter diagonal.
std::vector<std::uint32_t> triangulate(const QuadMesh& mesh) {
    std::vector<std::uint32_t> indices;
    for (const auto& q : mesh.quads) {
        const double first = glm::distance(mesh.vertices[q[0]], mesh.vertices[q[2]]);
        const double second = glm::distance(mesh.vertices[q[1]], mesh.vertices[q[3]]);
        const std::size_t k = first <= second ? 0 : 1;
        for (const std::size_t corner : {k, k + 1, k + 2, k, k + 2, (k + 3) % 4}) {
            indices.push_back(q[corner % 4]);
        }
    }
    return indices;
}

}  // namespace

MeshData mesh_vessels(const VesselTree& tree, double spacing_mm) {
    const VesselField field(tree, spacing_mm * block_size);
    QuadMesh quads =
        extract_isosurface([&](const glm::dvec3& p) { return field.distance(p); }, field.cubes(), spacing_mm);
    for (glm::dvec3& p : quads.vertices) {
        p = field.onto_wall(p);
    }
    for (int pass = 0; pass < 3; ++pass) {
        spread_vertices(quads, field);
    }
    MeshData mesh;
    mesh.indices = triangulate(quads);
    for (const glm::dvec3& p : quads.vertices) {
        mesh.positions.emplace_back(p);
        mesh.normals.emplace_back(field.gradient(p));
    }
    return mesh;
}

SurfaceCheck check_surface(const MeshData& mesh) {
    SurfaceCheck check;
    std::vector<std::uint32_t> parent(mesh.positions.size());
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root = [&](std::uint32_t v) {
        while (parent[v] != v) {
            parent[v] = parent[parent[v]];
            v = parent[v];
        }
        return v;
    };
    std::vector<std::pair<std::uint32_t, std::uint32_t>> directed;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        std::array<glm::dvec3, 3> p{};
        double longest = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t from = mesh.indices[t + k];
            const std::uint32_t to = mesh.indices[t + (k + 1) % 3];
            directed.emplace_back(from, to);
            parent[root(from)] = root(to);
            p[k] = glm::dvec3(mesh.positions[from]);
            longest = std::max(longest, glm::distance(p[k], glm::dvec3(mesh.positions[to])));
        }
        const double twice_area = glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
        check.degenerate += twice_area > 1e-3 * longest * longest ? 0U : 1U;
        check.volume_mm3 += glm::dot(p[0], glm::cross(p[1], p[2])) / 6.0;
    }
    std::sort(directed.begin(), directed.end());
    for (std::size_t i = 0; i < directed.size(); ++i) {
        const std::pair reverse{directed[i].second, directed[i].first};
        const bool repeated = (i > 0 && directed[i - 1] == directed[i]) ||
                              (i + 1 < directed.size() && directed[i + 1] == directed[i]);
        const bool paired = std::binary_search(directed.begin(), directed.end(), reverse);
        check.bad_edges += repeated || !paired ? 1U : 0U;
    }
    for (std::uint32_t v = 0; v < parent.size(); ++v) {
        check.components += root(v) == v ? 1U : 0U;
    }
    check.euler = static_cast<std::ptrdiff_t>(mesh.positions.size()) -
                  static_cast<std::ptrdiff_t>(directed.size() / 2) +
                  static_cast<std::ptrdiff_t>(mesh.triangle_count());
    return check;
}

}  // namespace viscera::assets

#include "engine/core/mesh_normals.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace viscera {
namespace {

constexpr float same_direction = 0.9999F;
constexpr double least_cosine = 0.5;

/// Per vertex the area of its triangles, times two.
std::vector<double> areas_of(const MeshData& mesh) {
    std::vector<double> areas(mesh.positions.size(), 0.0);
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const glm::dvec3 p(mesh.positions[mesh.indices[t]]);
        const double area = glm::length(glm::cross(glm::dvec3(mesh.positions[mesh.indices[t + 1]]) - p,
                                                   glm::dvec3(mesh.positions[mesh.indices[t + 2]]) - p));
        for (std::size_t k = 0; k < 3; ++k) {
            areas[mesh.indices[t + k]] += area;
        }
    }
    return areas;
}

}  // namespace

std::size_t join_normals(MeshData& mesh, std::span<const std::size_t> part_vertices,
                         std::span<const std::uint32_t> place) {
    if (part_vertices.size() < 2 || mesh.normals.size() != mesh.positions.size()) {
        return 0;
    }
    std::vector<std::uint32_t> part;
    for (std::size_t p = 0; p < part_vertices.size(); ++p) {
        part.insert(part.end(), part_vertices[p], static_cast<std::uint32_t>(p));
    }
    const std::vector<double> areas = areas_of(mesh);
    std::vector<std::uint32_t> vertices(mesh.positions.size());
    std::iota(vertices.begin(), vertices.end(), 0U);
    std::ranges::stable_sort(vertices, {}, [&](std::uint32_t v) { return place[v]; });

    std::size_t joined = 0;
    for (auto begin = vertices.begin(); begin != vertices.end();) {
        const auto end =
            std::find_if(begin, vertices.end(), [&](std::uint32_t v) { return place[v] != place[*begin]; });
        const std::span<const std::uint32_t> here(begin, end);
        begin = end;
        // Vertices of a part follow each other.
        bool meant = false;
        bool several = false;
        glm::dvec3 sum(0.0);
        for (std::size_t i = 0; i < here.size(); ++i) {
            const std::uint32_t v = here[i];
            sum += areas[v] * glm::dvec3(mesh.normals[v]);
            if (i > 0 && part[v] == part[here[i - 1]]) {
                meant = meant || glm::dot(mesh.normals[v], mesh.normals[here[i - 1]]) < same_direction;
            } else {
                several = several || i > 0;
            }
        }
        const double length = glm::length(sum);
        if (meant || !several || !(length > 0.0)) {
            continue;
        }
        const glm::dvec3 mean = sum / length;
        const bool smooth = std::ranges::all_of(here, [&](std::uint32_t v) {
            return glm::dot(glm::dvec3(mesh.normals[v]), mean) >= least_cosine;
        });
        if (smooth) {
            for (const std::uint32_t v : here) {
                mesh.normals[v] = glm::vec3(mean);
            }
            ++joined;
        }
    }
    return joined;
}

}  // namespace viscera

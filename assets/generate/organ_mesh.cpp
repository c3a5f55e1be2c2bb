#include "assets/generate/organ_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "assets/generate/isosurface.h"
#include "assets/generate/noise.h"
#include "assets/generate/vessel_mesh.h"
#include "engine/core/mesh_atlas.h"

namespace viscera::assets {
namespace {

// An edge of a right angle within a triangle leaves 0.7; two sheets that a grid mixes up leave less than 0.
constexpr double smallest_agreement = 0.25;

/// Blocks of the grid that hold the body or lie near it.
std::vector<glm::ivec3> blocks_of(const OrganField& field, double spacing) {
    const double edge = spacing * block_size;
    const int count = static_cast<int>(std::ceil(OrganField::reach_mm / edge));
    std::vector<glm::ivec3> blocks;
    for (int z = -count; z < count; ++z) {
        for (int y = -count; y < count; ++y) {
            for (int x = -count; x < count; ++x) {
                // The field is no true distance: twice what one would need.
                if (field.distance((glm::dvec3(x, y, z) + 0.5) * edge) < 2.0 * edge) {
                    blocks.emplace_back(x, y, z);
                }
            }
        }
    }
    return blocks;
}

void spread_vertices(QuadMesh& mesh, const OrganField& field) {
    std::vector<glm::dvec4> sums(mesh.vertices.size(), glm::dvec4(0.0));
    for (const auto& quad : mesh.quads) {
        for (std::size_t k = 0; k < 4; ++k) {
            sums[quad[k]] += glm::dvec4(mesh.vertices[quad[(k + 1) % 4]], 1.0);
        }
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const glm::dvec3 p = mesh.vertices[i];
        const glm::dvec3 normal = field.normal(p);
        const glm::dvec3 step = 0.6 * (glm::dvec3(sums[i]) / sums[i].w - p);
        mesh.vertices[i] = field.onto_surface(p + step - normal * glm::dot(step, normal));
    }
}

MeshData closed_surface(const OrganField& field, double spacing) {
    QuadMesh quads = extract_isosurface([&](const glm::dvec3& p) { return field.distance(p); },
                                        blocks_of(field, spacing), spacing);
    for (int pass = 0; pass < 3; ++pass) {
        spread_vertices(quads, field);
    }
    MeshData mesh;
    for (const auto& q : quads.quads) {
        const double first = glm::distance(quads.vertices[q[0]], quads.vertices[q[2]]);
        const double second = glm::distance(quads.vertices[q[1]], quads.vertices[q[3]]);
        const std::size_t k = first <= second ? 0 : 1;
        for (const std::size_t corner : {k, k + 1, k + 2, k, k + 2, (k + 3) % 4}) {
            mesh.indices.push_back(q[corner % 4]);
        }
    }
    for (const glm::dvec3& p : quads.vertices) {
        mesh.positions.emplace_back(p);
        mesh.normals.emplace_back(field.normal(p));
    }
    return mesh;
}

void add_atlas(MeshData& mesh) {
    std::vector<std::uint32_t> place(mesh.positions.size());
    std::iota(place.begin(), place.end(), 0U);
    const MeshAtlas atlas = make_atlas(mesh.positions, mesh.indices, place);
    for (const std::uint32_t vertex : atlas.origin) {
        mesh.positions.push_back(mesh.positions[vertex]);
        mesh.normals.push_back(mesh.normals[vertex]);
    }
    mesh.uvs = atlas.uvs;
    mesh.indices = atlas.indices;
}

}  // namespace

double least_agreement(const MeshData& mesh) {
    double least = 1.0;
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const auto corner = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[t + k]]); };
        const glm::dvec3 across = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
        const double length = glm::length(across);
        for (std::size_t k = 0; length > 0.0 && k < 3; ++k) {
            least = std::min(least, glm::dot(across, glm::dvec3(mesh.normals[mesh.indices[t + k]])) / length);
        }
    }
    return least;
}

MeshData mesh_organ(const OrganField& field, double spacing_mm) {
    for (int attempt = 0; attempt < 5; ++attempt) {
        MeshData mesh = closed_surface(field, spacing_mm);
        const SurfaceCheck check = check_surface(mesh);
        // Handles do no harm here: the duct may well close a ring.
        if (check.components == 1 && check.bad_edges == 0 && check.degenerate == 0 &&
            least_agreement(mesh) > smallest_agreement) {
            add_atlas(mesh);
            mesh.name = "organ";
            return mesh;
        }
        spacing_mm *= 0.96;
    }
    throw std::runtime_error("organ: cannot be meshed as one closed surface");
}

MeshData mesh_abdomen(std::uint64_t seed, int cells) {
    const auto noise_seed = static_cast<std::uint32_t>(seed * 31U + 7U);
    constexpr glm::dvec3 centre(0.0, 10.0, -10.0);
    constexpr glm::dvec3 half_lengths(175.0, 118.0, 165.0);
    // Angles from the pole at the diaphragm; the corners of the sheet reach round to the navel.
    constexpr double widest = 0.62 * std::numbers::pi;
    MeshData mesh;
    mesh.name = "abdomen";
    const auto place = [&](double u, double v) {
        const glm::dvec2 q = 2.0 * glm::dvec2(u, v) - 1.0;
        const double r = glm::length(q);
        const double angle = widest * std::min(r, 1.4);
        const glm::dvec2 way = r > 0.0 ? q / r : glm::dvec2(0.0);
        const glm::dvec3 unit(std::sin(angle) * way.x, -std::sin(angle) * way.y, std::cos(angle));
        const double folds = 4.0 * fractal_noise(unit * 3.1, 3, noise_seed);
        return centre + (half_lengths + folds) * unit;
    };
    const double step = 1.0 / cells;
    constexpr double tiny = 1e-4;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const double u = 0.02 + 0.96 * i * step;
            const double v = 0.02 + 0.96 * j * step;
            const glm::dvec3 du = place(u + tiny, v) - place(u - tiny, v);
            const glm::dvec3 dv = place(u, v + tiny) - place(u, v - tiny);
            mesh.positions.emplace_back(place(u, v));
            mesh.normals.emplace_back(glm::normalize(glm::cross(du, dv)));
            mesh.uvs.emplace_back(u, v);
        }
    }
    const auto row = static_cast<std::uint32_t>(cells + 1);
    for (std::uint32_t j = 0; j + 1 < row; ++j) {
        for (std::uint32_t i = 0; i + 1 < row; ++i) {
            const std::uint32_t a = j * row + i;
            for (const std::uint32_t corner : {a, a + 1, a + row + 1, a, a + row + 1, a + row}) {
                mesh.indices.push_back(corner);
            }
        }
    }
    return mesh;
}

}  // namespace viscera::assets

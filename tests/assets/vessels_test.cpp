#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "assets/generate/coronary.h"
#include "assets/generate/generate.h"
#include "assets/generate/tube.h"
#include "assets/generate/vessel_mesh.h"

namespace viscera::assets {
namespace {

std::vector<std::vector<std::uint32_t>> children_of(const CentrelineGraph& graph) {
    std::vector<std::vector<std::uint32_t>> children(graph.nodes.size());
    for (const CentrelineGraph::Edge& edge : graph.edges) {
        children[edge.a].push_back(edge.b);
    }
    return children;
}

const Coronary& coronary() {
    static const Coronary grown = grow_coronary(default_seed);
    return grown;
}

/// Number of branchings at which the cubes of the radii add up; fails at each where they do not.
int check_murray(const VesselTree& tree) {
    const auto children = children_of(tree.graph);
    int branchings = 0;
    for (std::size_t node = 0; node < children.size(); ++node) {
        if (children[node].size() < 2) {
            continue;
        }
        double cubes = 0.0;
        for (const std::uint32_t child : children[node]) {
            cubes += std::pow(tree.graph.nodes[child].radius_mm, 3.0);
        }
        EXPECT_NEAR(cubes, std::pow(tree.graph.nodes[node].radius_mm, 3.0), 1e-12) << "node " << node;
        ++branchings;
    }
    return branchings;
}

TEST(Coronary, obeys_murrays_law_at_every_branching) {
    EXPECT_GE(check_murray(coronary().tree), 40);
}

TEST(Coronary, has_the_calibre_and_the_number_of_vessels_of_a_left_tree) {
    const VesselTree& tree = coronary().tree;
    EXPECT_GE(tree.branches.size(), 40U);
    EXPECT_LE(tree.branches.size(), 80U);
    const auto [thinnest, widest] =
        std::minmax_element(tree.graph.nodes.begin(), tree.graph.nodes.end(),
                            [](const auto& a, const auto& b) { return a.radius_mm < b.radius_mm; });
    EXPECT_NEAR(widest->radius_mm, 2.2, 1e-12);
    EXPECT_GE(thinnest->radius_mm, 0.34);
    EXPECT_LE(thinnest->radius_mm, 0.45);
}

TEST(Coronary, is_one_tree_that_never_widens_downstream_of_the_ostium) {
    const VesselTree& tree = coronary().tree;
    EXPECT_EQ(tree.graph.edges.size() + 1, tree.graph.nodes.size());
    const std::uint32_t ostium = tree.branches[1].nodes[0];
    std::vector<bool> fed(tree.graph.nodes.size(), false);
    fed[0] = true;
    for (const CentrelineGraph::Edge& edge : tree.graph.edges) {
        EXPECT_TRUE(fed[edge.a]) << "edge from node " << edge.a << " stands before what feeds it";
        EXPECT_FALSE(fed[edge.b]) << "node " << edge.b << " is fed twice";
        fed[edge.b] = true;
        if (edge.a >= ostium) {
            EXPECT_LE(tree.graph.nodes[edge.b].radius_mm, tree.graph.nodes[edge.a].radius_mm + 1e-12);
        }
    }
    EXPECT_THAT(fed, testing::Each(true));
}

TEST(Coronary, lumens_of_different_vessels_stay_apart) {
    const VesselTree& tree = coronary().tree;
    for (std::size_t i = 0; i < tree.branches.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const Branch& young = tree.branches[i];
            const Branch& old = tree.branches[j];
            const bool siblings = young.nodes[0] == old.nodes[0];
            if (siblings || std::count(old.nodes.begin(), old.nodes.end(), young.nodes[0]) > 0) {
                continue;  // these two do touch, at their branching
            }
            for (const std::uint32_t a : young.nodes) {
                for (const std::uint32_t b : old.nodes) {
                    const auto& p = tree.graph.nodes[a];
                    const auto& q = tree.graph.nodes[b];
                    // The root node of a branch lies in its parent and carries the parent's radius.
                    const double radius_a = a == young.nodes[0] ? young.start_radius_mm : p.radius_mm;
                    const double radius_b = b == old.nodes[0] ? old.start_radius_mm : q.radius_mm;
                    ASSERT_GT(glm::distance(p.position_mm, q.position_mm), radius_a + radius_b)
                        << young.name << " touches " << old.name;
                }
            }
        }
    }
}

TEST(Coronary, another_seed_is_another_patient) {
    EXPECT_NE(grow_coronary(default_seed + 1).tree.graph.nodes.size(), 0U);
    EXPECT_NE(grow_coronary(default_seed + 1).tree.graph.nodes[200].position_mm,
              coronary().tree.graph.nodes[200].position_mm);
}

TEST(VesselMesh, coronary_is_one_closed_outward_surface_without_handles) {
    const MeshData mesh = mesh_vessels(coronary().tree, 0.42);
    const SurfaceCheck check = check_surface(mesh);
    EXPECT_EQ(check.components, 1U);
    EXPECT_EQ(check.bad_edges, 0U);
    EXPECT_EQ(check.degenerate, 0U);
    EXPECT_EQ(check.euler, 2);
    EXPECT_GT(check.volume_mm3, 2000.0);
    EXPECT_GE(mesh.triangle_count(), 60000U);
    EXPECT_LE(mesh.triangle_count(), 120000U);
}

TEST(VesselMesh, normals_are_unit_and_point_out_of_their_triangles) {
    const MeshData mesh = mesh_vessels(make_tube(), 1.3);
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const glm::vec3& normal : mesh.normals) {
        ASSERT_NEAR(glm::length(normal), 1.0F, 1e-5F);
    }
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
        const auto corner = [&](std::size_t k) { return mesh.positions[mesh.indices[t + k]]; };
        const glm::vec3 face = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
        for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_GT(glm::dot(face, mesh.normals[mesh.indices[t + k]]), 0.0F) << "triangle " << t / 3;
        }
    }
}

TEST(VesselMesh, check_finds_a_hole_a_flipped_triangle_and_a_second_piece) {
    const MeshData sound = mesh_vessels(make_tube(), 1.3);
    ASSERT_TRUE(check_surface(sound).sound());
    MeshData holed = sound;
    holed.indices.resize(holed.indices.size() - 3);
    EXPECT_EQ(check_surface(holed).bad_edges, 3U);
    MeshData flipped = sound;
    std::swap(flipped.indices[0], flipped.indices[1]);
    EXPECT_GT(check_surface(flipped).bad_edges, 0U);
    MeshData doubled = sound;
    const auto count = static_cast<std::uint32_t>(sound.positions.size());
    doubled.positions.insert(doubled.positions.end(), sound.positions.begin(), sound.positions.end());
    for (const std::uint32_t index : sound.indices) {
        doubled.indices.push_back(index + count);
    }
    EXPECT_EQ(check_surface(doubled).components, 2U);
    MeshData inverted = sound;
    std::reverse(inverted.indices.begin(), inverted.indices.end());
    EXPECT_LT(check_surface(inverted).volume_mm3, 0.0);
}

TEST(Tube, walls_lie_at_the_stated_radii) {
    const VesselTree tube = make_tube();
    EXPECT_EQ(check_murray(tube), 1);
    EXPECT_NEAR(tube.branches[1].start_radius_mm, 3.0 / std::cbrt(2.0), 1e-12);
    const MeshData mesh = mesh_vessels(tube, 1.3);
    EXPECT_LT(mesh.triangle_count(), 3000U);
    std::size_t on_stem = 0;
    for (const glm::vec3& p : mesh.positions) {
        if (p.z > -38.0F && p.z < -8.0F) {
            ASSERT_NEAR(std::hypot(p.x, p.y), 3.0F, 1e-4F);
            ++on_stem;
        }
    }
    EXPECT_GT(on_stem, 100U);
}

TEST(Tube, density_falls_from_the_inlet_to_the_tips) {
    const VesselTree tube = make_tube();
    const MeshData mesh = mesh_vessels(tube, 1.3);
    const VertexScalars density = tube_density(tube, mesh);
    EXPECT_EQ(density.name, "_DENSITY");
    ASSERT_EQ(density.values.size(), mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const float z = mesh.positions[i].z;
        if (z < -10.0F) {  // on the stem the way travelled is 40 mm + z, of 70 mm
            ASSERT_NEAR(density.values[i], 1.0F - std::max(0.0F, z + 40.0F) / 70.0F, 1e-5F);
        }
    }
    EXPECT_EQ(*std::min_element(density.values.begin(), density.values.end()), 0.0F);
    EXPECT_EQ(*std::max_element(density.values.begin(), density.values.end()), 1.0F);
}

}  // namespace
}  // namespace viscera::assets

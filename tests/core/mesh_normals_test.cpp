#include "engine/core/mesh_normals.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace viscera::test {
namespace {

/// Two triangles of one part each that meet along the z axis and rise from it at `slope`, with the normals
/// that each has of its own; the second has an area of `wider` times the first's.
MeshData roof(float slope, float wider = 1.0F) {
    MeshData mesh;
    mesh.positions = {{0, 0, 0}, {0, 0, 1}, {-1, slope, 0}, {0, 0, 0}, {0, 0, 1}, {wider, wider * slope, 0}};
    mesh.indices = {0, 1, 2, 3, 5, 4};
    const glm::vec3 left = glm::normalize(glm::vec3(slope, 1, 0));
    const glm::vec3 right = glm::normalize(glm::vec3(-slope, 1, 0));
    mesh.normals = {left, left, left, right, right, right};
    return mesh;
}
constexpr std::array<std::uint32_t, 6> places{0, 1, 2, 0, 1, 5};
constexpr std::array<std::size_t, 2> two_parts{3, 3};

TEST(JoinNormals, WherePartsMeetTheMeanHolds) {
    MeshData mesh = roof(0.3F);
    const glm::vec3 away = mesh.normals[2];
    EXPECT_EQ(join_normals(mesh, two_parts, places), 2U);
    for (const std::size_t v : {0U, 1U, 3U, 4U}) {
        EXPECT_NEAR(glm::distance(mesh.normals[v], glm::vec3(0, 1, 0)), 0.0F, 1e-6F) << v;
    }
    EXPECT_EQ(mesh.normals[2], away) << "elsewhere nothing changes";
}

TEST(JoinNormals, LargeTrianglesWeighMore) {
    MeshData mesh = roof(0.3F, 3.0F);
    EXPECT_EQ(join_normals(mesh, two_parts, places), 2U);
    const glm::vec3 left = glm::normalize(glm::vec3(0.3, 1, 0));
    const glm::vec3 right = glm::normalize(glm::vec3(-0.3, 1, 0));
    EXPECT_NEAR(glm::distance(mesh.normals[0], glm::normalize(left + 3.0F * right)), 0.0F, 1e-6F);
}

TEST(JoinNormals, CornersStay) {
    MeshData mesh = roof(2.5F);
    const MeshData before = mesh;
    EXPECT_EQ(join_normals(mesh, two_parts, places), 0U);
    EXPECT_EQ(mesh.normals, before.normals);
    // Back to back.
    mesh = roof(0.0F);
    mesh.normals[3] = mesh.normals[4] = mesh.normals[5] = {0, -1, 0};
    EXPECT_EQ(join_normals(mesh, two_parts, places), 0U);
}

TEST(JoinNormals, EdgesWithinAPartStay) {
    MeshData mesh = roof(0.3F);
    EXPECT_EQ(join_normals(mesh, std::array<std::size_t, 1>{6}, places), 0U)
        << "one part: as its author has it";
    // A second vertex of the first part at the first place, with a normal of its own.
    mesh.positions.insert(mesh.positions.begin() + 3, mesh.positions[0]);
    mesh.normals.insert(mesh.normals.begin() + 3, glm::vec3(0, 0.9F, 0.43F));
    mesh.indices = {0, 1, 2, 4, 6, 5};
    const std::array<std::uint32_t, 7> seven{0, 1, 2, 0, 0, 1, 6};
    EXPECT_EQ(join_normals(mesh, std::array<std::size_t, 2>{4, 3}, seven), 1U);
    EXPECT_EQ(mesh.normals[3], glm::vec3(0, 0.9F, 0.43F));
}

TEST(JoinNormals, WithoutNormalsOrAreaNothingHappens) {
    MeshData mesh = roof(0.3F);
    mesh.normals.clear();
    EXPECT_EQ(join_normals(mesh, two_parts, places), 0U);
    mesh = roof(0.3F);
    for (glm::vec3& p : mesh.positions) {
        p = glm::vec3(0.0F);
    }
    EXPECT_EQ(join_normals(mesh, two_parts, std::array<std::uint32_t, 6>{}), 0U);
}

}  // namespace
}  // namespace viscera::test

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "effects/tissue/surface_search.h"

namespace viscera::tissue {
namespace {

/// Triangles anywhere, some of them without an extent.
MeshData scattered(int triangles) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> within(-1.0F, 1.0F);
    MeshData mesh;
    for (int t = 0; t < triangles; ++t) {
        const glm::vec3 at(20.0F * within(random), 20.0F * within(random), 20.0F * within(random));
        for (int k = 0; k < 3; ++k) {
            const glm::vec3 side(within(random), within(random), within(random));
            mesh.positions.push_back(at + (t % 10 == 0 ? 0.0F : 2.0F) * side);
            mesh.uvs.emplace_back(within(random), within(random));
            mesh.indices.push_back(static_cast<std::uint32_t>(3 * t + k));
        }
    }
    return mesh;
}

TEST(SurfaceSearch, TheTreeFindsTheNearestPointOfAllTriangles) {
    const MeshData mesh = scattered(500);
    const glm::dmat4 to_world(1.5);
    const TriangleTree tree(mesh, to_world);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> within(-40.0, 40.0);
    for (int i = 0; i < 400; ++i) {
        const glm::dvec3 place(within(random), within(random), within(random));
        const auto expected = nearest_point(mesh, to_world, place);
        const auto found = tree.nearest(place);
        ASSERT_TRUE(expected && found);
        EXPECT_EQ(found->triangle, expected->triangle);
        EXPECT_NEAR(found->distance, expected->distance, 1e-9);
        EXPECT_LT(glm::length(found->uv - expected->uv), 1e-9);
    }
    EXPECT_FALSE(TriangleTree().nearest(glm::dvec3(0.0)).has_value());
}

TEST(SurfaceSearch, TheTexturesBorderIsNotItsOppositeOne) {
    const float last = std::nextafter(1.0F, 0.0F);
    EXPECT_EQ(within_texture({0.0, 1.0}), glm::vec2(0.0F, last));
    EXPECT_EQ(within_texture({1.0, 0.25}), glm::vec2(last, 0.25F));
    EXPECT_EQ(within_texture({1.0 - 1e-12, 0.5}), glm::vec2(last, 0.5F));
    // Beyond it the texture is repeated.
    EXPECT_EQ(within_texture({1.25, -0.25}), glm::vec2(0.25F, 0.75F));
    EXPECT_EQ(within_texture({-1e-12, 7.5}), glm::vec2(last, 0.5F));
}

}  // namespace
}  // namespace viscera::tissue

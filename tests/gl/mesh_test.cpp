#include "engine/gl/mesh.h"

#include <algorithm>

#include "tests/gl/drawing.h"
#include "tests/gl/gl_test.h"

namespace viscera::test {
namespace {

/// Two squares, left and right half of the target, two triangles each.
MeshData two_squares() {
    MeshData data;
    for (const float left : {-1.0F, 0.0F}) {
        const auto first = static_cast<std::uint32_t>(data.positions.size());
        for (const glm::vec2 corner :
             {glm::vec2(0, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(0, 1)}) {
            data.positions.emplace_back(left + corner.x, corner.y, 0.0F);
        }
        for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) {
            data.indices.push_back(first + i);
        }
    }
    return data;
}

class MeshTest : public GlTest {
  protected:
    /// Left and right pixel of a target of 2 x 1: normal.x, uv.y, scalar, 1.
    [[nodiscard]] std::array<glm::vec4, 2> draw(const gl::Mesh& mesh, std::size_t first = 0,
                                                std::size_t count = 1000) {
        canvas_.begin(gl(), gl::overwrite_state);
        canvas_.framebuffer.clear_colour(0, {-1.0F, -1.0F, -1.0F, -1.0F});
        program_.use();
        mesh.draw_range(first, count);
        const Image image = canvas_.read(gl());
        std::array<glm::vec4, 2> pixels{};
        for (int x = 0; x < 2; ++x) {
            for (int c = 0; c < 4; ++c) {
                pixels.at(static_cast<std::size_t>(x))[c] = image.at(x, 0, c);
            }
        }
        return pixels;
    }

    Canvas canvas_{gl(), 2, 1};
    gl::Program program_{
        gl(),
        shader("#version 330 core\n"
               "in vec3 a_normal; in float a_scalar; in vec2 a_uv; in vec3 a_position;\n"
               "out vec4 value;\n"
               "void main() { gl_Position = vec4(a_position, 1.0);\n"
               "    value = vec4(a_normal.x, a_uv.y, a_scalar, 1.0); }\n"),
        shader("#version 330 core\nin vec4 value; out vec4 colour;\nvoid main() { colour = value; }\n"),
        "mesh"};
};

const glm::vec4 nothing(-1.0F);

TEST_P(MeshTest, AttributesThatAreMissingReadAsConstants) {
    // The context's own values must not show through.
    for (GLuint location = 0; location < 5; ++location) {
        gl().VertexAttrib4f(location, 9.0F, 9.0F, 9.0F, 9.0F);
    }
    const gl::Mesh mesh(gl(), two_squares());
    EXPECT_EQ(mesh.triangle_count(), 4U);
    const auto [left, right] = draw(mesh);
    EXPECT_EQ(left, glm::vec4(0, 0, 0, 1));
    EXPECT_EQ(right, glm::vec4(0, 0, 0, 1));
}

TEST_P(MeshTest, EachAttributeArrivesAndIsReplacedAlone) {
    MeshData data = two_squares();
    data.normals.assign(8, glm::vec3(0.5F, 0, 0));
    data.uvs.assign(8, glm::vec2(0, 0.25F));
    data.scalars = {{"density", std::vector<float>(8, 2.0F)}, {"arrival", std::vector<float>(8, 3.0F)}};
    gl::Mesh mesh(gl(), data);
    EXPECT_EQ(draw(mesh)[0], glm::vec4(0.5F, 0.25F, 2.0F, 1.0F));

    const std::size_t bytes = mesh.bytes();
    std::vector<float> density(8, 4.0F);
    std::fill(density.begin() + 4, density.end(), 5.0F);
    mesh.update_scalars("density", density);
    mesh.update_normals(std::vector<glm::vec3>(8, glm::vec3(0.75F, 0, 0)));
    mesh.update_uvs(std::vector<glm::vec2>(8, glm::vec2(0, 1)));
    EXPECT_EQ(mesh.bytes(), bytes);
    EXPECT_EQ(draw(mesh)[0], glm::vec4(0.75F, 1.0F, 4.0F, 1.0F));
    EXPECT_EQ(draw(mesh)[1], glm::vec4(0.75F, 1.0F, 5.0F, 1.0F));

    EXPECT_TRUE(mesh.select_scalar("arrival"));
    EXPECT_EQ(draw(mesh)[0].z, 3.0F);
    EXPECT_FALSE(mesh.select_scalar("pressure"));
    EXPECT_EQ(draw(mesh)[0].z, 0.0F);
    mesh.update_scalars("pressure", std::vector<float>(8, 6.0F));
    EXPECT_TRUE(mesh.select_scalar("pressure"));
    EXPECT_EQ(draw(mesh)[0].z, 6.0F);
}

TEST_P(MeshTest, PositionsMove) {
    MeshData data = two_squares();
    gl::Mesh mesh(gl(), data);
    for (glm::vec3& position : data.positions) {
        position.x += 1.0F;
    }
    mesh.update_positions(data.positions);
    EXPECT_EQ(draw(mesh)[0], nothing);
    EXPECT_EQ(draw(mesh)[1].w, 1.0F);
}

TEST_P(MeshTest, RangesAreClipped) {
    const gl::Mesh mesh(gl(), two_squares());
    EXPECT_EQ(draw(mesh, 0, 2)[1], nothing);
    EXPECT_NE(draw(mesh, 0, 2)[0], nothing);
    EXPECT_EQ(draw(mesh, 2, 2)[0], nothing);
    EXPECT_NE(draw(mesh, 2, 99)[1], nothing);
    EXPECT_EQ(draw(mesh, 99, 1)[1], nothing);
    EXPECT_EQ(draw(mesh, 1, 0)[0], nothing);
}

TEST_P(MeshTest, TheOrderOfIndicesIsTheOrderOfDrawing) {
    MeshData data = two_squares();
    for (std::size_t i = 0; i < 4; ++i) {
        data.positions[i + 4] = data.positions[i];  // both left
    }
    data.scalars = {{"density", {1, 1, 1, 1, 2, 2, 2, 2}}};
    gl::Mesh mesh(gl(), data);
    EXPECT_EQ(draw(mesh)[0].z, 2.0F);
    std::rotate(data.indices.begin(), data.indices.begin() + 6, data.indices.end());
    mesh.update_indices(data.indices);
    EXPECT_EQ(draw(mesh)[0].z, 1.0F);
    mesh.update_indices(std::span(data.indices).first(6));
    EXPECT_EQ(mesh.triangle_count(), 2U);
    EXPECT_EQ(draw(mesh)[0].z, 2.0F);
}

TEST_P(MeshTest, AnEmptyMeshDrawsNothing) {
    gl::Mesh mesh(gl(), MeshData{});
    EXPECT_EQ(draw(mesh)[0], nothing);
    mesh.update_indices({});
    EXPECT_FALSE(mesh.select_scalar(""));
}

TEST_P(MeshTest, WrongCountsAndIndicesAreRefused) {
    gl::Mesh mesh(gl(), two_squares());
    const std::vector<float> few(7);
    EXPECT_TRUE(error_of([&] { mesh.update_scalars("density", few); }));
    EXPECT_TRUE(error_of([&] { mesh.update_positions(std::vector<glm::vec3>(9)); }));
    EXPECT_TRUE(error_of([&] { mesh.update_indices(std::vector<std::uint32_t>{0, 1}); }));
    EXPECT_TRUE(error_of([&] { mesh.update_indices(std::vector<std::uint32_t>{0, 1, 8}); }));
    EXPECT_EQ(draw(mesh)[0], glm::vec4(0, 0, 0, 1));
}

TEST_P(MeshTest, MovesWithItsBuffers) {
    gl::Mesh first(gl(), two_squares());
    const gl::Mesh second = std::move(first);
    EXPECT_EQ(draw(second)[1].w, 1.0F);
}

INSTANTIATE_TEST_SUITE_P(Backends, MeshTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

#include "engine/io/mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "engine/core/error.h"
#include "engine/core/mesh_adjacency.h"
#include "engine/io/file_info.h"
#include "tests/io/sample_files.h"
#include "tests/io/temp_folder.h"

namespace viscera::io {
namespace {

using test::TempFolder;
using testing::HasSubstr;

std::string message_of(const auto& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return "";
}

class Meshes : public testing::Test {
  protected:
    std::vector<MeshData> load(const char* name, const std::string& bytes, const MeshOptions& options = {}) {
        std::vector<MeshData> meshes = load_meshes(folder_.write(name, bytes), options, log_);
        for (const MeshData& mesh : meshes) {
            test::expect_valid(mesh);
        }
        return meshes;
    }

    TempFolder folder_;
    Log log_;
};

TEST_F(Meshes, EveryFormatGivesTheSameTetrahedron) {
    const std::vector<std::pair<const char*, std::string>> files{
        {"a.stl", test::tetra_stl()}, {"text.stl", test::tetra_stl_text()}, {"a.obj", test::tetra_obj()},
        {"a.ply", test::tetra_ply()}, {"b.ply", test::tetra_ply_binary()},  {"a.vtp", test::tetra_vtp()},
        {"A.GLB", test::tetra_glb()}};
    for (const auto& [name, bytes] : files) {
        const std::vector<MeshData> meshes = load(name, bytes);
        ASSERT_EQ(meshes.size(), 1U) << name;
        const double edge_mm = std::string_view(name) == "A.GLB" ? 1000.0 : 1.0;
        EXPECT_EQ(meshes[0].positions.size(), 4U) << name;
        EXPECT_EQ(meshes[0].triangle_count(), 4U) << name;
        EXPECT_NEAR(test::volume_of(meshes[0]) / (edge_mm * edge_mm * edge_mm), 1.0 / 6.0, 1e-6) << name;
        for (std::size_t v = 0; v < 4; ++v) {  // computed normals point away from the middle
            const glm::vec3 middle(0.25F * static_cast<float>(edge_mm));
            EXPECT_GT(glm::dot(meshes[0].normals[v], meshes[0].positions[v] - middle), 0.0F) << name;
        }
    }
    EXPECT_TRUE(log_.faults().empty());
}

TEST_F(Meshes, ScaleReplacesTheFormatsOwn) {
    EXPECT_EQ(load("a.glb", test::tetra_glb(), {.scale_mm_per_unit = 2.0})[0].bounds().max.x, 2.0F);
    EXPECT_EQ(load("a.stl", test::tetra_stl(), {.scale_mm_per_unit = 10.0})[0].bounds().max.z, 10.0F);
    for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(static_cast<void>(load("a.stl", test::tetra_stl(), {.scale_mm_per_unit = bad})), Error);
    }
}

TEST_F(Meshes, BadTrianglesAreCountedAndDropped) {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv nan 0 0\n";
    const MeshData mesh = load("a.obj", points + "f 1 2 3\nf 1 2 4\nf 1 1 2\nf 1 2 5\n").at(0);
    EXPECT_EQ(mesh.triangle_count(), 1U);
    EXPECT_EQ(mesh.positions.size(), 3U);
    const auto faults = log_.faults();
    EXPECT_EQ(faults.at("mesh: triangles without area dropped"), 2U);
    EXPECT_EQ(faults.at("mesh: triangles with a vertex that is not finite dropped"), 1U);
}

/// Corners of the same winding in any order are one triangle; the other winding is its back, which stays.
TEST_F(Meshes, TrianglesThatAreThereTwiceAreDropped) {
    const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
    const MeshData mesh = load("a.obj", points + "f 1 2 3\nf 2 4 3\nf 2 3 1\nf 3 1 2\nf 1 3 2\n").at(0);
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2, 0, 2, 1}));
    EXPECT_EQ(log_.faults().at("mesh: triangles that are there twice dropped"), 2U);
}

TEST_F(Meshes, WhatOnlySomeCornersHaveIsLeftOutAndSaid) {
    const std::string lists = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n";
    const MeshData mesh = load("a.obj", lists + "f 1/1/1 2/2/1 3/3/1\nf 2//1 4//1 3/9/1\n").at(0);
    EXPECT_TRUE(mesh.uvs.empty());
    EXPECT_EQ(log_.faults().at("mesh: texture coordinates left out that not all corners have"), 3U);
    EXPECT_FALSE(log_.faults().contains("mesh: normals left out that not all corners have"));
}

/// A triangle that is dropped takes nothing from the others.
TEST_F(Meshes, ADroppedTriangleTakesNoCoordinatesAlong) {
    const std::string lists = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
    const MeshData mesh = load("a.obj", lists + "f 1/1 2/2 3/3\nf 1/1 2/2 9/9\n").at(0);
    EXPECT_EQ(mesh.triangle_count(), 1U);
    EXPECT_EQ(mesh.uvs.size(), 3U);
}

/// A sphere as programs write it, whose lower pole is a ring of points at sin(pi) = 1.2e-16: closed all the
/// same.
TEST_F(Meshes, PlacesThatDifferByRoundingAreOne) {
    constexpr int columns = 12;
    constexpr int rows = 6;
    std::string text;
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const double theta = std::numbers::pi * row / rows;
            const double phi = 2.0 * std::numbers::pi * column / columns;
            std::ostringstream line;
            line << std::setprecision(17) << "v " << 25.0 * std::sin(theta) * std::cos(phi) << ' '
                 << 25.0 * std::cos(theta) << ' ' << 25.0 * std::sin(theta) * std::sin(phi) << '\n';
            text += line.str();
        }
    }
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const int a = row * columns + column + 1;
            const int b = row * columns + (column + 1) % columns + 1;
            for (const auto& [p, q, r] :
                 {std::array{a, b, b + columns}, std::array{a, b + columns, a + columns}}) {
                text += "f " + std::to_string(p) + ' ' + std::to_string(q) + ' ' + std::to_string(r) + '\n';
            }
        }
    }
    const MeshData sphere = load("sphere.obj", text).at(0);
    const MeshAdjacency adjacency = find_adjacency(sphere.indices, first_at_same_place(sphere.positions));
    EXPECT_EQ(sphere.triangle_count(), 2U * columns * (rows - 1)) << "without those at the poles";
    EXPECT_EQ(adjacency.open_edges, 0U);
    EXPECT_EQ(adjacency.non_manifold_edges, 0U);
    // Neighbours of floats at the mesh's own size stay apart.
    const std::vector<glm::vec3> apart{
        {25.0F, 0.0F, 0.0F}, {25.0F + 0x1p-17F, 0.0F, 0.0F}, {25.0F, 1e-20F, 0.0F}};
    EXPECT_EQ(first_at_same_place(apart), (std::vector<std::uint32_t>{0, 1, 0}));
    EXPECT_EQ(first_at_same_place(std::vector<glm::vec3>{{3e38F, 0.0F, 0.0F}, {2e38F, 0.0F, 0.0F}}),
              (std::vector<std::uint32_t>{0, 1}));
}

TEST_F(Meshes, NothingLeftIsSaidAndReturned) {
    const std::vector<MeshData> meshes = load("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    ASSERT_EQ(meshes.size(), 1U);
    EXPECT_TRUE(meshes[0].indices.empty());
    EXPECT_TRUE(meshes[0].positions.empty());
    EXPECT_EQ(log_.faults().at("mesh: without triangles"), 1U);
}

TEST_F(Meshes, PolygonsAreSplit) {
    const MeshData mesh = load("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").at(0);
    EXPECT_EQ(mesh.triangle_count(), 2U);
    EXPECT_EQ(mesh.positions.size(), 4U);
    EXPECT_EQ(mesh.normals[0], glm::vec3(0.0F, 0.0F, 1.0F));
}

TEST_F(Meshes, ObjCornersGroupsAndBackwardIndices) {
    const std::string text =
        "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 2\n"
        "g first\nf 1/1/1 2/2/1 \\\n3/3/1\ng second\nf -3 -2 -1\nf 1 2 9\nl 1 2\n";
    const std::vector<MeshData> meshes = load("a.obj", text);
    ASSERT_EQ(meshes.size(), 2U);
    EXPECT_EQ(meshes[0].name, "first");
    EXPECT_EQ(meshes[0].uvs[2], glm::vec2(0.0F, 1.0F));
    EXPECT_EQ(meshes[0].normals[0], glm::vec3(0.0F, 0.0F, 1.0F));
    EXPECT_EQ(meshes[1].name, "second");
    EXPECT_EQ(meshes[1].triangle_count(), 1U);
    EXPECT_TRUE(meshes[1].uvs.empty());
    EXPECT_EQ(log_.faults().at("mesh: triangles with an index out of range dropped"), 1U);
    EXPECT_EQ(log_.faults().at("mesh: points and lines left out"), 1U);
}

TEST_F(Meshes, PlyReadsBigEndianNormalsAndFurtherProperties) {
    std::string bytes =
        "ply\nformat binary_big_endian 1.0\ncomment made by hand\nelement vertex 3\nproperty double "
        "x\nproperty "
        "double y\nproperty double z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty "
        "short "
        "quality\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n";
    const auto append = [&](auto value) {
        std::string raw = test::bytes_of(value);
        std::ranges::reverse(raw);
        bytes += raw;
    };
    for (int v = 0; v < 3; ++v) {
        append(v == 1 ? 1.0 : 0.0);
        append(v == 2 ? 1.0 : 0.0);
        append(0.5);
        append(0.0F);
        append(0.0F);
        append(-1.0F);
        append(static_cast<std::int16_t>(-v));
    }
    append(std::uint8_t{3});
    for (const std::uint32_t index : {0U, 1U, 2U}) {
        append(index);
    }
    const MeshData mesh = load("a.ply", bytes).at(0);
    EXPECT_EQ(mesh.positions[2], glm::vec3(0.0F, 1.0F, 0.5F));
    EXPECT_EQ(mesh.normals[0], glm::vec3(0.0F, 0.0F, -1.0F));
    ASSERT_EQ(mesh.scalars.size(), 1U);
    EXPECT_EQ(mesh.scalars[0].name, "quality");
    EXPECT_EQ(mesh.scalars[0].values, (std::vector<float>{0.0F, -1.0F, -2.0F}));
}

TEST_F(Meshes, AHeaderThatPromisesTooMuchIsRefused) {
    std::string ply = test::tetra_ply_binary();
    ply.replace(ply.find("vertex 4"), 8, "vertex 4000000000");
    EXPECT_THAT(message_of([&] { load("a.ply", ply); }), HasSubstr("promises more vertices than it holds"));
    // Enough bytes for as many vertices of one property, but not of a thousand.
    std::string wide = "ply\nformat binary_little_endian 1.0\nelement vertex 4000\n";
    for (int i = 0; i < 1000; ++i) {
        wide += "property float p" + std::to_string(i) + "\n";
    }
    wide += "end_header\n" + std::string(16'000, '\0');
    EXPECT_THAT(message_of([&] { load("a.ply", wide); }), HasSubstr("promises more vertices than it holds"));
    const std::string text = "ply\nformat ascii 1.0\nelement vertex %\nproperty float x\nend_header\n1 2 3";
    const auto counted = [&](const char* count) {
        return std::string(text).replace(text.find('%'), 1, count);
    };
    EXPECT_EQ(load("a.ply", counted("3")).at(0).triangle_count(), 0U);
    EXPECT_THAT(message_of([&] { load("a.ply", counted("4")); }), HasSubstr("promises more vertices"));
    std::string stl = test::tetra_stl();
    stl[80] = 5;
    EXPECT_THAT(message_of([&] { load("a.stl", stl); }), HasSubstr("nor of the size that its header says"));
}

TEST_F(Meshes, AnStlTextMayHoldSeveralSolids) {
    const std::string one = test::tetra_stl_text();
    std::string other = one;
    for (std::size_t at = other.find("solid "); at != std::string::npos; at = other.find("solid ", at + 1)) {
        other.replace(at, other.find('\n', at) - at, "solid left renal");
    }
    const std::vector<MeshData> both = load("a.stl", one + other);
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(both[1].name, "left");
    EXPECT_EQ(both[0].triangle_count(), 4U);
    EXPECT_EQ(both[1].triangle_count(), 4U);
    EXPECT_EQ(load("a.stl", one + other, {.name_filter = "left"}).size(), 1U);
    EXPECT_THAT(message_of([&] { load("a.stl", one + "facet"); }),
                HasSubstr("'facet' follows a solid's end"));
    EXPECT_THAT(message_of([&] { load("a.stl", one + one.substr(0, one.size() / 2)); }),
                HasSubstr("is cut off"));
}

TEST_F(Meshes, ErrorsNameTheFile) {
    EXPECT_THAT(message_of([&] { load("a.fbx", "x"); }), HasSubstr("a.fbx: is no mesh that can be read"));
    EXPECT_THAT(message_of([&] { load("a.stl", "x"); }), HasSubstr("a.stl: is no readable STL file"));
    EXPECT_THAT(message_of([&] { static_cast<void>(load_meshes(folder_ / "no.stl", {}, log_)); }),
                HasSubstr("no.stl: cannot be opened"));
    EXPECT_THAT(message_of([&] { load("a.glb", test::tetra_glb(), {.name_filter = "vein"}); }),
                HasSubstr("no mesh has 'vein' in its name; there are 'node'"));
}

TEST_F(Meshes, FilterLooksAtNodeAndMeshNames) {
    EXPECT_EQ(load("a.glb", test::tetra_glb(), {.name_filter = "nod"}).size(), 1U);
    EXPECT_EQ(load("a.glb", test::tetra_glb(), {.name_filter = "tetra"}).size(), 1U);
}

MeshData triangle(float x) {
    MeshData mesh;
    mesh.positions = {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}};
    mesh.indices = {0, 1, 2};
    return mesh;
}

TEST(Merge, JoinsIndicesScalarsAndNormals) {
    MeshData a = triangle(0.0F);
    a.name = "a";
    a.uvs.assign(3, glm::vec2(0.5F));
    a.scalars = {{"_T", {1, 2, 3}}};
    MeshData b = triangle(5.0F);
    b.scalars = {{"_U", {4, 5, 6}}};
    const MeshData merged = merge(std::vector<MeshData>{a, b});
    test::expect_valid(merged);
    EXPECT_EQ(merged.name, "a");
    EXPECT_EQ(merged.indices, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
    ASSERT_EQ(merged.uvs.size(), 6U);
    EXPECT_EQ(merged.uvs[2], glm::vec2(0.5F));
    EXPECT_EQ(merged.uvs[3], glm::vec2(0.0F));
    EXPECT_TRUE(merge(std::vector<MeshData>{b, b}).uvs.empty());
    EXPECT_EQ(merged.normals[5], glm::vec3(0.0F, 0.0F, 1.0F));
    ASSERT_EQ(merged.scalars.size(), 2U);
    EXPECT_EQ(merged.scalars[0].values, (std::vector<float>{1, 2, 3, 0, 0, 0}));
    EXPECT_EQ(merged.scalars[1].values, (std::vector<float>{0, 0, 0, 4, 5, 6}));
    EXPECT_TRUE(merge({}).positions.empty());
}

TEST(VertexNormals, WeighByAngleNotByTheNumberOfTriangles) {
    // Three sides of a cube at one corner, one of them split in two: its diagonal must not count twice.
    MeshData mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}};
    mesh.indices = {0, 2, 4, 0, 4, 1, 0, 3, 2, 0, 1, 3};
    const glm::vec3 normal = vertex_normals(mesh)[0];
    EXPECT_NEAR(normal.x, -1.0 / std::sqrt(3.0), 1e-6);
    EXPECT_NEAR(normal.y, -1.0 / std::sqrt(3.0), 1e-6);
    EXPECT_NEAR(normal.z, -1.0 / std::sqrt(3.0), 1e-6);
}

TEST(VertexNormals, BackToBackTrianglesStillHaveOne) {
    MeshData mesh = triangle(0.0F);
    mesh.indices = {0, 1, 2, 0, 2, 1};
    EXPECT_EQ(vertex_normals(mesh)[1], glm::vec3(0.0F, 0.0F, 1.0F));
}

TEST(FileInfo, TellsClosedFromOpenAndWhichWayRound) {
    const TempFolder folder;
    nlohmann::json info = describe(folder.write("a.glb", test::tetra_glb()));
    EXPECT_EQ(info["kind"], "meshes");
    EXPECT_EQ(info["meshes"][0]["vertices"], 4);
    EXPECT_EQ(info["meshes"][0]["closed"], true);
    EXPECT_EQ(info["meshes"][0]["orientation"], "outward");
    EXPECT_EQ(info["meshes"][0]["scalars"][0]["name"], "_DENSITY");
    EXPECT_EQ(info["meshes"][0]["scalars"][0]["max"], 1.0);
    info = describe(folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
    EXPECT_EQ(info["meshes"][0]["closed"], false);
}

TEST(FileInfo, UnknownFilesSayWhatToDo) {
    const TempFolder folder;
    EXPECT_THAT(message_of([&] { static_cast<void>(describe(folder.write("a.fbx", ""))); }),
                testing::AllOf(HasSubstr(".glb"), HasSubstr("Blender")));
    EXPECT_THAT(message_of([&] { static_cast<void>(describe(folder.write("a.xyz", ""))); }),
                HasSubstr("assimp"));
}

}  // namespace
}  // namespace viscera::io

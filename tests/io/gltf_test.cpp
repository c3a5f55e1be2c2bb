#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/io/mesh.h"
#include "tests/io/sample_files.h"
#include "tests/io/temp_folder.h"

namespace viscera::io {
namespace {

using test::bytes_of;
using test::TempFolder;
using testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

class Gltf : public testing::Test {
  protected:
    std::vector<MeshData> load(const std::string& json, const std::string& binary = test::tetra_binary()) {
        std::vector<MeshData> meshes =
            load_meshes(folder_.write("a.glb", test::glb(json, binary)), {.scale_mm_per_unit = 1.0}, log_);
        for (const MeshData& mesh : meshes) {
            test::expect_valid(mesh);
        }
        return meshes;
    }

    std::string refusal(const std::string& json) {
        try {
            load(json);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file);
            return error.what();
        }
        return "accepted";
    }

    std::string refusal(const std::string& from, const std::string& to) {
        return refusal(replaced(test::tetra_json(), from, to));
    }

    /// A mesh of one primitive whose accessors and views the test gives.
    static std::string document(const std::string& primitive, const std::string& accessors,
                                const std::string& views, std::size_t bytes) {
        return R"({"asset":{"version":"2.0"},"meshes":[{"name":"m","primitives":[)" + primitive +
               R"(]}],"accessors":[)" + accessors + R"(],"bufferViews":[)" + views +
               R"(],"buffers":[{"byteLength":)" + std::to_string(bytes) + "}]}";
    }

    TempFolder folder_;
    Log log_;
};

TEST_F(Gltf, ScalarsAndNamesComeAlong) {
    const MeshData mesh = load(test::tetra_json()).at(0);
    EXPECT_EQ(mesh.name, "node");
    ASSERT_EQ(mesh.scalars.size(), 1U);
    EXPECT_EQ(mesh.scalars[0].name, "_DENSITY");
    EXPECT_EQ(mesh.scalars[0].values, (std::vector<float>{0.25F, 0.5F, 0.75F, 1.0F}));
}

TEST_F(Gltf, AlphaOfVertexColoursIsAScalar) {
    const std::string json =
        document(R"({"attributes":{"POSITION":0,"COLOR_0":1}})",
                 R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
                 R"({"bufferView":1,"componentType":5121,"normalized":true,"count":3,"type":"VEC4"})",
                 R"({"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12})", 48);
    const std::string binary = bytes_of(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}) +
                               bytes_of(std::vector<std::uint8_t>{9, 9, 9, 0, 9, 9, 9, 51, 9, 9, 9, 255});
    const MeshData mesh = load(json, binary).at(0);
    ASSERT_EQ(mesh.scalars.size(), 1U);
    EXPECT_EQ(mesh.scalars[0].name, "COLOR_0.a");
    EXPECT_EQ(mesh.scalars[0].values, (std::vector<float>{0.0F, 0.2F, 1.0F}));
    // Colours without alpha have none.
    EXPECT_TRUE(
        load(replaced(replaced(json, "VEC4", "VEC3"), "5121,", "5121,"), binary).at(0).scalars.empty());
}

TEST_F(Gltf, NodeTransformsAreApplied) {
    // Turned by 90 degrees about z, then doubled along x of the mesh, then moved.
    const MeshData mesh =
        load(test::tetra_json(
                 "", R"(,"translation":[10,0,0],"rotation":[0,0,0.70710678,0.70710678],"scale":[2,1,1])"))
            .at(0);
    EXPECT_NEAR(mesh.positions[1].x, 10.0F, 1e-5F);
    EXPECT_NEAR(mesh.positions[1].y, 2.0F, 1e-5F);
    EXPECT_NEAR(test::volume_of(mesh), 2.0 / 6.0, 1e-6);
}

TEST_F(Gltf, MirroredNodesKeepTheirTrianglesOutward) {
    EXPECT_NEAR(test::volume_of(load(test::tetra_json("", R"(,"scale":[-1,1,1])")).at(0)), 1.0 / 6.0, 1e-6);
    const std::string matrix = R"(,"matrix":[1,0,0,0,0,-1,0,0,0,0,1,0,5,6,7,1])";
    const MeshData mesh = load(test::tetra_json("", matrix)).at(0);
    EXPECT_NEAR(test::volume_of(mesh), 1.0 / 6.0, 1e-5);
    EXPECT_EQ(mesh.positions[2], glm::vec3(5.0F, 5.0F, 7.0F));
}

TEST_F(Gltf, MirroredNormalsPointWithTheirTriangles) {
    const std::string json =
        document(R"({"attributes":{"POSITION":0,"NORMAL":1}})",
                 R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
                 R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC3"})",
                 R"({"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":36})", 72);
    const std::string mirrored =
        replaced(json, R"("meshes")", R"("nodes":[{"mesh":0,"scale":[1,1,-2]}],"meshes")");
    const MeshData mesh =
        load(mirrored, bytes_of(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 3, 0, 0, 3}))
            .at(0);
    EXPECT_EQ(mesh.normals[0], glm::vec3(0.0F, 0.0F, -1.0F));
    EXPECT_EQ(vertex_normals(mesh)[0], glm::vec3(0.0F, 0.0F, -1.0F));
}

TEST_F(Gltf, NormalisedIntegersStridesAndStrips) {
    // Two interleaved attributes, 8 bytes apart: positions as normalised bytes, a scalar as normalised short.
    std::string binary;
    const std::vector<std::array<std::int8_t, 3>> points{{0, 0, 0}, {127, 0, 0}, {0, 127, 0}, {127, 127, 0}};
    for (std::size_t v = 0; v < 4; ++v) {
        for (const std::int8_t c : points[v]) {
            binary += bytes_of(c);
        }
        binary += '\0';
        binary += bytes_of(static_cast<std::int16_t>(v == 3 ? -32768 : 32767)) + std::string(2, '\0');
    }
    const MeshData mesh =
        load(
            document(
                R"({"mode":5,"attributes":{"POSITION":0,"_T":1}})",
                R"({"bufferView":0,"componentType":5120,"normalized":true,"count":4,"type":"VEC3"},)"
                R"({"bufferView":0,"byteOffset":4,"componentType":5122,"normalized":true,"count":4,"type":"SCALAR"})",
                R"({"buffer":0,"byteLength":32,"byteStride":8})", 32),
            binary)
            .at(0);
    EXPECT_EQ(mesh.triangle_count(), 2U);
    EXPECT_EQ(mesh.positions[3], glm::vec3(1.0F, 1.0F, 0.0F));
    EXPECT_EQ(mesh.scalars[0].values, (std::vector<float>{1.0F, 1.0F, 1.0F, -1.0F}));
    for (const glm::vec3& normal : mesh.normals) {
        EXPECT_EQ(normal, glm::vec3(0.0F, 0.0F, 1.0F));
    }
}

TEST_F(Gltf, SparseValuesTakeTheirPlaces) {
    const std::string binary =
        bytes_of(std::vector<std::uint8_t>{1, 2, 0, 0}) + bytes_of(std::vector<float>{3, 0, 0, 0, 4, 0});
    const MeshData mesh =
        load(document(R"({"attributes":{"POSITION":0}})",
                      R"({"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":2,)"
                      R"("indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":1}}})",
                      R"({"buffer":0,"byteLength":4},{"buffer":0,"byteOffset":4,"byteLength":24})", 28),
             binary)
            .at(0);
    EXPECT_EQ(mesh.positions[0], glm::vec3(0.0F));
    EXPECT_EQ(mesh.positions[1], glm::vec3(3.0F, 0.0F, 0.0F));
    EXPECT_EQ(mesh.positions[2], glm::vec3(0.0F, 4.0F, 0.0F));
}

TEST_F(Gltf, IndicesOutOfRangeAreDropped) {
    std::string binary = test::tetra_binary();
    binary[48] = 99;
    const MeshData mesh = load(test::tetra_json(), binary).at(0);
    EXPECT_EQ(mesh.triangle_count(), 3U);
    EXPECT_EQ(log_.faults().at("mesh: triangles with an index out of range dropped"), 1U);
}

TEST_F(Gltf, AnIndexOutOfRangeDoesNotReachTheNextPart) {
    std::string binary = test::tetra_binary();
    binary[48] = 4;
    const std::string json = test::tetra_json();
    const std::string part = R"({"attributes":{"POSITION":0,"_DENSITY":2},"indices":1})";
    EXPECT_EQ(load(replaced(json, part, part + "," + part), binary).at(0).triangle_count(), 6U);
}

TEST_F(Gltf, PointsAndLinesAreLeftOutAndSaid) {
    EXPECT_TRUE(load(replaced(test::tetra_json(), R"("indices":1)", R"("indices":1,"mode":1)"))
                    .at(0)
                    .indices.empty());
    EXPECT_EQ(log_.faults().at("mesh: points and lines left out"), 1U);
}

TEST_F(Gltf, SkinsAndMorphTargetsAreLeftOutAndSaid) {
    const MeshData plain = load(test::tetra_json()).at(0);
    EXPECT_TRUE(log_.faults().empty());
    const std::string skinned = replaced(test::tetra_json(), R"("mesh":0)", R"("mesh":0,"skin":0)");
    EXPECT_EQ(load(replaced(skinned, R"("indices":1)", R"("indices":1,"targets":[{"POSITION":0}])"))
                  .at(0)
                  .positions,
              plain.positions);
    EXPECT_EQ(log_.faults().at("mesh: skins and morph targets left out"), 2U);
    EXPECT_THAT(refusal(R"("indices":1)", R"("indices":1,"targets":7)"), "accepted");
    EXPECT_NE(refusal(R"({"asset":{"version":"2.0"},"nodes":{"skin":1},"meshes":[7,{"primitives":3}]})"),
              "accepted");
}

TEST_F(Gltf, LyingReferencesAreRefusedByPointer) {
    EXPECT_THAT(refusal(R"("POSITION":0)", R"("POSITION":7)"),
                HasSubstr("/meshes/0/primitives/0/attributes/POSITION"));
    EXPECT_THAT(refusal(R"("count":4,)", R"("count":5,)"),
                HasSubstr("/accessors/0: reaches beyond its buffer view"));
    EXPECT_THAT(refusal(R"("count":4,)", R"("count":4294967295,)"), HasSubstr("/accessors/0"));
    EXPECT_THAT(refusal(R"("count":4,)", R"("count":-4,)"), HasSubstr("/accessors/0/count"));
    EXPECT_THAT(refusal(R"("byteLength":48)", R"("byteLength":4800)"),
                HasSubstr("/bufferViews/0: reaches beyond"));
    EXPECT_THAT(refusal(R"("byteLength":88)", R"("byteLength":8800)"), HasSubstr("/buffers/0/byteLength"));
    EXPECT_THAT(refusal(R"("mesh":0)", R"("mesh":1)"), HasSubstr("/nodes/0/mesh: there is no mesh 1"));
    EXPECT_THAT(refusal(R"("scene":0)", R"("scene":1)"), HasSubstr("/scene"));
    EXPECT_THAT(refusal(R"("type":"VEC3")", R"("type":"VEC4")"), HasSubstr("/accessors/0"));
    EXPECT_THAT(refusal(R"("indices":1)", R"("indices":2)"),
                HasSubstr("/indices: must be unsigned integers"));
    EXPECT_THAT(refusal(R"("version":"2.0")", R"("version":"1.0")"), HasSubstr("/asset/version"));
    EXPECT_THAT(refusal(R"("scene":0)", R"("extensionsRequired":["KHR_draco_mesh_compression"],"scene":0)"),
                HasSubstr("KHR_draco_mesh_compression"));
}

TEST_F(Gltf, NodeCyclesAndSharedChildrenAreRefused) {
    EXPECT_THAT(refusal(R"("name":"node",)", R"("name":"node","children":[0],)"),
                HasSubstr("is its own ancestor"));
    EXPECT_THAT(refusal(R"({"name":"node",)", R"({"children":[2]},{"children":[1]},{"name":"node",)"),
                HasSubstr("/nodes/"));
    EXPECT_THAT(refusal(R"({"name":"node",)", R"({"children":[2]},{"children":[2]},{"name":"node",)"),
                HasSubstr("two parents"));
}

TEST_F(Gltf, DeepNestingIsSurvived) {
    const std::string deep = std::string(100000, '[') + std::string(100000, ']');
    EXPECT_THAT(refusal(R"("scene":0)", R"("extras":)" + deep + R"(,"scene":0)"),
                HasSubstr("nested too deeply"));
    std::string chain;
    for (int i = 1; i < 20000; ++i) {
        chain += R"({"children":[)" + std::to_string(i) + "]},";
    }
    std::string json = replaced(test::tetra_json(), R"({"name":"node",)", chain + R"({"name":"node",)");
    EXPECT_EQ(load(json).at(0).triangle_count(), 4U);
}

TEST_F(Gltf, BuffersLieInsideTheFolderOrNowhere) {
    const auto load_uri = [&](const std::string& uri) {
        const auto file = folder_.write("sub/a.gltf", test::tetra_json(R"(,"uri":")" + uri + "\""));
        try {
            return std::to_string(load_meshes(file, {}, log_).at(0).triangle_count());
        } catch (const Error& error) {
            return std::string(error.what());
        }
    };
    std::filesystem::create_directories(folder_ / "sub/deeper");
    static_cast<void>(folder_.write("outside.bin", test::tetra_binary()));
    static_cast<void>(folder_.write("sub/b c.bin", test::tetra_binary()));
    static_cast<void>(folder_.write("sub/deeper/b.bin", test::tetra_binary()));
    std::filesystem::create_symlink(folder_ / "outside.bin", folder_ / "sub/link.bin");
    EXPECT_EQ(load_uri("b%20c.bin"), "4");
    EXPECT_EQ(load_uri("deeper/b.bin"), "4");
    EXPECT_EQ(load_uri("deeper/../b c.bin"), "4");
    EXPECT_THAT(load_uri("../outside.bin"), HasSubstr("/buffers/0/uri: '../outside.bin' leaves the folder"));
    EXPECT_THAT(load_uri("%2e%2e/outside.bin"), HasSubstr("leaves the folder"));
    EXPECT_THAT(load_uri("link.bin"), HasSubstr("leaves the folder"));
    EXPECT_THAT(load_uri((folder_ / "sub/b c.bin").string()), HasSubstr("leaves the folder"));
    EXPECT_THAT(load_uri("http://example.org/b.bin"), HasSubstr("leaves the folder"));
    EXPECT_THAT(load_uri("none.bin"), HasSubstr("cannot be opened"));
    EXPECT_EQ(load_uri("data:application/octet-stream;base64," + test::base64(test::tetra_binary())), "4");
    EXPECT_THAT(load_uri("data:application/octet-stream;base64,AAAA"), HasSubstr("/buffers/0/byteLength"));
}

}  // namespace
}  // namespace viscera::io

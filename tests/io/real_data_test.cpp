#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "engine/io/file_info.h"
#include "engine/io/mesh.h"
#include "engine/io/png.h"
#include "tests/io/sample_files.h"

namespace viscera::io {
namespace {

class RealData : public testing::Test {
  protected:
    void SetUp() override {
        if (folder_.empty() || !std::filesystem::is_directory(folder_)) {
            GTEST_SKIP() << "VISCERA_DATA_DIR names no folder with real data";
        }
    }

    [[nodiscard]] std::vector<MeshData> load(const char* name) {
        std::vector<MeshData> meshes = load_meshes(folder_ / name, {}, log_);
        for (const MeshData& mesh : meshes) {
            test::expect_valid(mesh);
        }
        EXPECT_TRUE(log_.faults().empty()) << log_.faults().begin()->first;
        return meshes;
    }

    const std::filesystem::path folder_ = VISCERA_DATA_DIR;
    Log log_;
};

std::size_t vertices(const std::vector<MeshData>& meshes) {
    std::size_t count = 0;
    for (const MeshData& mesh : meshes) {
        count += mesh.positions.size();
    }
    return count;
}

std::size_t triangles(const std::vector<MeshData>& meshes) {
    std::size_t count = 0;
    for (const MeshData& mesh : meshes) {
        count += mesh.triangle_count();
    }
    return count;
}

TEST_F(RealData, AortaIsTheSameFromStlAndVtp) {
    const MeshData stl = load("vessels/aorta-surface.stl").at(0);
    const MeshData vtp = load("vessels/aorta-surface.vtp").at(0);
    for (const MeshData* mesh : {&stl, &vtp}) {
        EXPECT_EQ(mesh->positions.size(), 6468U);
        EXPECT_EQ(mesh->triangle_count(), 12932U);
        EXPECT_NEAR(test::volume_of(*mesh), -13184.0, 1.0);  // its triangles point inwards
        EXPECT_NEAR(mesh->bounds().min.x, 205.62F, 0.005F);
        EXPECT_NEAR(mesh->bounds().max.z, 35.36F, 0.005F);
    }
    ASSERT_EQ(vtp.scalars.size(), 1U);
    EXPECT_EQ(vtp.scalars[0].name, "Scalars_");
    const nlohmann::json info = describe(folder_ / "vessels/aorta-surface.stl");
    EXPECT_EQ(info["meshes"][0]["closed"], true);
    EXPECT_EQ(info["meshes"][0]["orientation"], "inward");
}

TEST_F(RealData, CentrelineLinesShareTheirTrunk) {
    const CentrelineGraph graph = load_centreline(folder_ / "vessels/aorta-centerline.vtp", log_);
    EXPECT_TRUE(log_.faults().empty());
    EXPECT_EQ(graph.nodes.size(), 346U);  // the different places among its 409 points
    EXPECT_EQ(graph.edges.size(), 345U);  // a tree
    const auto [low, high] = std::ranges::minmax_element(graph.nodes, {}, &CentrelineGraph::Node::radius_mm);
    EXPECT_NEAR(low->radius_mm, 2.776, 0.001);
    EXPECT_NEAR(high->radius_mm, 7.578, 0.001);
    const nlohmann::json info = describe(folder_ / "vessels/aorta-centerline.vtp");
    EXPECT_EQ(info["kind"], "centreline");
    EXPECT_EQ(info["centrelines"][0]["ends"], 3);
    EXPECT_EQ(info["centrelines"][0]["branchings"], 1);
    EXPECT_FALSE(
        load_centreline(folder_ / "vessels/aorta-centerline-attribute-branches.vtp", log_).edges.empty());
}

TEST_F(RealData, VasculatureComesInMillimetres) {
    const std::vector<MeshData> meshes = load("vessels/VH_F_Vasculature.glb");
    EXPECT_EQ(meshes.size(), 78U);
    EXPECT_EQ(vertices(meshes), 111520U);
    EXPECT_EQ(triangles(meshes), 218216U);
    const MeshData all = merge(meshes);
    test::expect_valid(all);
    EXPECT_EQ(all.triangle_count(), 218216U);
    EXPECT_NEAR(all.bounds().min.x, -77.0F, 1.0F);
    EXPECT_NEAR(all.bounds().max.y, 571.0F, 1.0F);
}

TEST_F(RealData, KhronosSamplesLoad) {
    const MeshData box = load("gltf/BoxInterleaved.glb").at(0);
    EXPECT_EQ(box.positions.size(), 24U);
    EXPECT_EQ(box.triangle_count(), 12U);
    EXPECT_NEAR(test::volume_of(box), 1e9, 1e3);
    const std::vector<MeshData> truck = load("gltf/CesiumMilkTruck.glb");
    EXPECT_EQ(truck.size(), 3U);  // two pairs of wheels show one mesh
    EXPECT_EQ(truck[0].name, "Cesium_Milk_Truck");
    EXPECT_EQ(truck[2].name, truck[1].name);
    EXPECT_EQ(triangles(truck), 2856U + 768U);
}

TEST_F(RealData, OrgansLoad) {
    const MeshData liver = load("organs/liver-smoothUV.obj").at(0);
    EXPECT_EQ(liver.triangle_count(), 4384U);
    EXPECT_GT(test::volume_of(liver), 0.0);
    EXPECT_EQ(liver.uvs.size(), liver.positions.size());
    const std::vector<std::uint32_t> first = first_at_same_place(liver.positions);
    std::size_t places = 0;
    for (std::uint32_t v = 0; v < first.size(); ++v) {
        places += first[v] == v ? 1 : 0;
    }
    EXPECT_EQ(places, 2194U);
    EXPECT_EQ(vertices(load("organs/VH_M_Spleen.glb")), 9014U);
    const Image tile = read_image(folder_ / "organs/liver-texture-square.png");
    EXPECT_EQ(tile.width, 264);
    EXPECT_EQ(tile.height, 264);
}

/// Two of its 60,369 triangles have an edge of less than a float's last place.
TEST_F(RealData, ALiverWithoutItsTwoSliversLoads) {
    const std::vector<MeshData> liver = load_meshes(folder_ / "organs/VH_M_Liver.glb", {}, log_);
    EXPECT_EQ(triangles(liver), 60367U);
    EXPECT_EQ(log_.faults().size(), 1U);
    EXPECT_EQ(log_.faults().at("mesh: triangles without area dropped"), 2U);
}

}  // namespace
}  // namespace viscera::io

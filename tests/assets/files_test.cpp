#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "assets/generate/coronary.h"
#include "assets/generate/generate.h"
#include "assets/generate/tube.h"
#include "assets/generate/vessel_mesh.h"
#include "assets/generate/write_file.h"
#include "assets/generate/write_glb.h"

namespace viscera::assets {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
  protected:
    void SetUp() override {
        const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(testing::TempDir()) / (std::string("viscera_assets_") + test->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path folder_;
};

std::string bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::uint32_t word_at(const std::string& bytes, std::size_t offset) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes.data() + offset, sizeof(word));
    return word;
}

TEST_F(Files, are_the_same_bytes_each_time) {
    generate_all(folder_ / "first", default_seed, 4);
    generate_all(folder_ / "second", default_seed, 4);
    int compared = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_ / "first")) {
        if (entry.is_regular_file()) {
            const fs::path twin = folder_ / "second" / fs::relative(entry.path(), folder_ / "first");
            const std::string bytes = bytes_of(entry.path());
            EXPECT_FALSE(bytes.empty()) << entry.path();
            EXPECT_TRUE(bytes == bytes_of(twin)) << entry.path();
            ++compared;
        }
    }
    EXPECT_EQ(compared, 30);
}

TEST_F(Files, centreline_is_a_tree_in_millimetres) {
    write_centreline(grow_coronary(default_seed).tree.graph, folder_ / "tree.json");
    const auto json = nlohmann::json::parse(bytes_of(folder_ / "tree.json"));
    EXPECT_EQ(json.at("unit"), "mm");
    const auto& nodes = json.at("nodes");
    const auto& edges = json.at("edges");
    EXPECT_EQ(nodes.size(), edges.size() + 1);
    for (const auto& node : nodes) {
        ASSERT_EQ(node.size(), 4U);
        ASSERT_GT(node[3].get<double>(), 0.3);
    }
    for (const auto& edge : edges) {
        ASSERT_EQ(edge.size(), 2U);
        ASSERT_LT(edge[0].get<std::size_t>(), nodes.size());
        ASSERT_LT(edge[1].get<std::size_t>(), nodes.size());
    }
}

TEST_F(Files, glb_holds_metres_normals_and_the_custom_attribute) {
    const VesselTree tube = make_tube();
    MeshData mesh = mesh_vessels(tube, 1.3);
    mesh.name = "tube";
    mesh.scalars.push_back(tube_density(tube, mesh));
    write_glb(mesh, folder_ / "tube.glb");
    const std::string bytes = bytes_of(folder_ / "tube.glb");
    ASSERT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word_at(bytes, 4), 2U);
    EXPECT_EQ(word_at(bytes, 8), bytes.size());
    const std::uint32_t json_size = word_at(bytes, 12);
    const auto json = nlohmann::json::parse(bytes.substr(20, json_size));
    const auto& attributes = json.at("meshes")[0].at("primitives")[0].at("attributes");
    EXPECT_THAT(attributes, testing::SizeIs(3));
    const auto accessor = [&](const char* name) {
        return json.at("accessors")[attributes.at(name).get<std::size_t>()];
    };
    EXPECT_EQ(accessor("_DENSITY").at("count"), mesh.positions.size());
    EXPECT_EQ(accessor("NORMAL").at("type"), "VEC3");
    EXPECT_NEAR(accessor("POSITION").at("min")[2].get<double>(), -0.043, 1e-4);  // stem and its round cap
    const std::size_t binary = 20 + json_size;
    EXPECT_EQ(bytes.substr(binary + 4, 4), std::string("BIN\0", 4));
    EXPECT_EQ(binary + 8 + word_at(bytes, binary), bytes.size());
    EXPECT_EQ(json.at("buffers")[0].at("byteLength"), word_at(bytes, binary));
    float first_x = 0.0F;
    std::memcpy(&first_x, bytes.data() + binary + 8, sizeof(first_x));
    EXPECT_EQ(first_x, mesh.positions[0].x / 1000.0F);
}

TEST_F(Files, unwritable_folder_is_an_error_that_names_the_file) {
    std::ofstream(folder_ / "vessels") << "a file where a folder must go";
    try {
        generate_vessels(folder_, default_seed);
        FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("coronary.centreline.json"));
    }
}

}  // namespace
}  // namespace viscera::assets

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "engine/core/error.h"
#include "engine/io/exr.h"
#include "engine/io/mesh.h"
#include "engine/io/png.h"
#include "tests/io/sample_files.h"
#include "tests/io/temp_folder.h"

namespace viscera::io {
namespace {

using test::TempFolder;

/// Loads a whole file and checks what it gives.
using Load = std::function<void(const std::filesystem::path&)>;

void load_mesh(const std::filesystem::path& file) {
    Log log;
    for (const MeshData& mesh : load_meshes(file, {}, log)) {
        test::expect_valid(mesh);
    }
}

void load_picture(const std::filesystem::path& file) {
    const Image image = read_image(file);
    EXPECT_EQ(image.data.size(), static_cast<std::size_t>(image.width) *
                                     static_cast<std::size_t>(image.height) * bytes_per_pixel(image.format));
}

void load_lines(const std::filesystem::path& file) {
    Log log;
    const CentrelineGraph graph = load_centreline(file, log);
    for (const CentrelineGraph::Edge& edge : graph.edges) {
        ASSERT_LT(edge.a, graph.nodes.size());
        ASSERT_LT(edge.b, graph.nodes.size());
    }
}

struct Sample {
    const char* name;
    std::string bytes;
    Load load;
};

std::string picture_bytes(const char* name) {
    const TempFolder folder;
    Image image = make_image(9, 6, PixelFormat::rgba16f);
    for (int i = 0; i < 54; ++i) {
        image.set(i % 9, i / 9, i % 4, static_cast<float>(i) / 54.0F);
    }
    const std::filesystem::path file = folder / name;
    if (file.extension() == ".png") {
        write_png(file, image);
    } else {
        const ExrPart part{"a", image, {}, {{"note", "text"}}};
        const std::vector<ExrPart> parts{part, {"b", image, {}, {}}};
        const bool multi = file.stem() == "multi";
        write_exr(file, multi ? std::span(parts) : std::span(&part, 1),
                  multi ? ExrCompression::piz : ExrCompression::zip);
    }
    return test::slurp(file);
}

std::vector<Sample> samples() {
    return {{"a.glb", test::tetra_glb(), load_mesh},
            {"a.gltf",
             test::tetra_json(R"(,"uri":"data:application/octet-stream;base64,)" +
                              test::base64(test::tetra_binary()) + "\""),
             load_mesh},
            {"a.stl", test::tetra_stl(), load_mesh},
            {"text.stl", test::tetra_stl_text(), load_mesh},
            {"a.obj", test::tetra_obj(), load_mesh},
            {"a.ply", test::tetra_ply(), load_mesh},
            {"binary.ply", test::tetra_ply_binary(), load_mesh},
            {"a.vtp", test::tetra_vtp(), load_mesh},
            {"a.json", R"({"unit":"mm","nodes":[[0,0,0,1],[0,0,9,2]],"edges":[[0,1]]})", load_lines},
            {"a.png", picture_bytes("a.png"), load_picture},
            {"a.exr", picture_bytes("a.exr"), load_picture},
            {"multi.exr", picture_bytes("multi.exr"), load_picture}};
}

class Damage : public testing::TestWithParam<std::size_t> {
  protected:
    /// A damaged file gives a valid result or Error(file) or Error(limit); whatever else escapes fails.
    void expect_survived(const std::string& bytes) {
        const std::filesystem::path file = folder_.write(sample_.name, bytes);
        try {
            sample_.load(file);
        } catch (const Error& error) {
            EXPECT_TRUE(error.code() == ErrorCode::file || error.code() == ErrorCode::limit) << error.what();
            EXPECT_EQ(error.where(), file.string());
        }
    }

    Sample sample_ = samples()[GetParam()];
    TempFolder folder_;
};

TEST_P(Damage, TheWholeFileLoads) {
    EXPECT_NO_THROW(sample_.load(folder_.write(sample_.name, sample_.bytes)));
}

TEST_P(Damage, TruncationIsSurvived) {
    const std::size_t step = std::max<std::size_t>(1, sample_.bytes.size() / 300);
    for (std::size_t size = 0; size < sample_.bytes.size(); size += step) {
        expect_survived(sample_.bytes.substr(0, size));
    }
}

TEST_P(Damage, FlippedBytesAreSurvived) {
    std::mt19937 random(20240607U);
    std::uniform_int_distribution<std::size_t> place(0, sample_.bytes.size() - 1);
    std::uniform_int_distribution<int> value(0, 255);
    for (int round = 0; round < 400; ++round) {
        std::string bytes = sample_.bytes;
        for (int flips = 0; flips <= round % 4; ++flips) {
            bytes[place(random)] = static_cast<char>(value(random));
        }
        expect_survived(bytes);
    }
}

INSTANTIATE_TEST_SUITE_P(Files, Damage, testing::Range(std::size_t{0}, samples().size()),
                         [](const testing::TestParamInfo<std::size_t>& info) {
                             std::string name = samples()[info.param].name;
                             std::ranges::replace(name, '.', '_');
                             return name;
                         });

}  // namespace
}  // namespace viscera::io

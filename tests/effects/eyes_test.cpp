#include <gtest/gtest.h>

#include "engine/core/scene.h"
#include "tests/effects/stage.h"

// Two eyes in one frame, through the effects of whole scenes.

namespace viscera::test {
namespace {

bool same_bits(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height && a.format == b.format && a.data == b.data;
}

Scene small_scene(const std::string& name, const char* stereo) {
    const auto file = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes" / (name + ".json");
    std::vector<SceneOverride> changes{parse_override("/resolution=[72,64]")};
    if (stereo != nullptr) {
        changes.push_back(parse_override(std::string("/camera/stereo=") + stereo));
    }
    return load_scene(file, changes);
}

class EyesOfScenes : public testing::TestWithParam<std::string> {
  protected:
    Stage stage_;
};

TEST_P(EyesOfScenes, EachEyesPictureIsThatOfAFrameWithThatEyeAlone) {
    Renderer& renderer = stage_.renderer();
    renderer.set_scene(small_scene(GetParam(), R"({"interpupillary_mm": 90})"));
    Frame frame = renderer.still(1.5);
    ASSERT_EQ(frame.eye_count, 2);
    renderer.render(frame);
    const std::size_t assets_of_two = renderer.asset_count();
    std::vector<std::vector<Image>> of_two;
    for (const std::string& output : renderer.scene().outputs) {
        std::vector<Image> eyes;
        for (const std::string& name : renderer.names_of(output)) {
            eyes.push_back(renderer.read(name));
        }
        of_two.push_back(std::move(eyes));
    }
    bool differ = false;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        Stage alone;
        alone.renderer().set_scene(small_scene(GetParam(), nullptr));
        Frame single = alone.renderer().still(1.5);
        single.eyes[0] = frame.eyes[eye];
        alone.renderer().render(single);
        for (std::size_t o = 0; o < of_two.size(); ++o) {
            const Image wanted = alone.renderer().read(alone.renderer().scene().outputs[o]);
            const Image& got = of_two[o][of_two[o].size() == 2 ? eye : 0];
            EXPECT_TRUE(same_bits(got, wanted)) << alone.renderer().scene().outputs[o] << ", eye " << eye;
            differ = differ || (of_two[o].size() == 2 && !same_bits(of_two[o][0], of_two[o][1]));
        }
        EXPECT_EQ(alone.renderer().asset_count(), assets_of_two)
            << "files, volumes, bricks, meshes and textures are there once, not per eye";
    }
    EXPECT_TRUE(differ);
}

TEST_P(EyesOfScenes, AStillFrameOfTwoEyesDrawsNothingAgain) {
    Renderer& renderer = stage_.renderer();
    renderer.set_scene(small_scene(GetParam(), R"({"layout": "side_by_side"})"));
    renderer.render(renderer.still(1.5));
    for (const PassReport& pass : renderer.render(renderer.still(1.5)).passes) {
        EXPECT_TRUE(pass.status != PassStatus::run && pass.status != PassStatus::reduced) << pass.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Eyes, EyesOfScenes, testing::Values("angiography", "mixed"),
                         [](const auto& info) { return info.param; });

TEST(EyesOfAChain, WhatDoesNotDependOnTheEyeRunsOnce) {
    Stage stage;
    Renderer& renderer = stage.renderer();
    renderer.set_scene(small_scene("angiography", "{}"));
    const FrameReport& report = renderer.render(renderer.still(1.5));
    std::size_t once = 0;
    for (const PassReport& pass : report.passes) {
        once += pass.eye < 0 && pass.status == PassStatus::run ? 1U : 0U;
        if (pass.effect == "picture.image") {
            EXPECT_EQ(pass.eye, -1) << "a photograph is the same for both";
        }
        if (pass.effect == "contrast.geometry") {
            EXPECT_GE(pass.eye, 0);
        }
    }
    EXPECT_GE(once, 1U);
}

}  // namespace
}  // namespace viscera::test

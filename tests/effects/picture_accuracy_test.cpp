#include <gtest/gtest.h>

#include "tests/effects/deviation.h"
#include "tests/effects/noise_pictures.h"
#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/reference/contrast.h"

// Passes over whole pictures against the double-precision reference, which reads what the pass really read.
namespace viscera::test {
namespace {

using nlohmann::json;
using reference::Buffer;

constexpr int width = 96;
constexpr int height = 64;
constexpr std::size_t least_content = 1000;

class PictureAccuracy : public testing::TestWithParam<bool> {
  protected:
    /// Renders with all inputs kept; targets[0] is the result.
    void render(json passes, std::initializer_list<const char*> targets, json target_sizes = json::object()) {
        json scene = scene_of(tube_camera(), std::move(passes), {*targets.begin()}, width, height);
        scene["targets"] = std::move(target_sizes);
        if (GetParam()) {
            use_floats(scene, targets);
        }
        stage_.load(scene);
        stage_.renderer().keep({targets.begin(), targets.end()});
        stage_.render(0.0);
        EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front();
    }
    Buffer read(const char* target) { return to_buffer(stage_.renderer().read(target)); }
    void expect(const std::string& name, const char* target, const Buffer& wanted) {
        const Image image = stage_.renderer().read(target);
        expect_accurate(name, image.format, deviation(image, wanted), least_content);
    }

    NoisePictures pictures_;
    Stage stage_;
};

TEST_P(PictureAccuracy, Summarize) {
    using reference::Transition;
    for (const auto& [transition, wanted] : {std::pair("smooth", Transition::smooth),
                                             {"thesis", Transition::thesis},
                                             {"densest", Transition::densest}}) {
        render({NoisePictures::fill("contrast.main", pictures_.noise(1, width, height)),
                NoisePictures::fill("contrast.cloud", pictures_.noise(2, width, height), false),
                pass("summarize", "contrast.summarize", {{"transition", transition}})},
               {"contrast.summary", "contrast.main", "contrast.cloud"},
               {{"contrast.cloud", {{"format", "rg16f"}}}});
        // The distance map is the cloud's weight before its threshold, which noise does not have.
        const Buffer cloud = read("contrast.cloud");
        Buffer distance(cloud.width, cloud.height);
        for (std::size_t i = 0; i < distance.data.size(); ++i) {
            distance.data[i] = cloud.data[2 * i + 1];
        }
        expect(std::string("summarize, ") + transition, "contrast.summary",
               reference::summarize(read("contrast.main"), cloud, distance, wanted));
    }
}

TEST_P(PictureAccuracy, CompositeOfAllLayers) {
    for (const char* tone : {"beer_lambert", "thesis"}) {
        render({NoisePictures::fill("background", pictures_.noise(4, width, height)),
                NoisePictures::fill("contrast.summary", pictures_.noise(5, width, height, 0.0F, 0.7F)),
                NoisePictures::fill("contrast.reflux", pictures_.noise(6, width, height, 0.0F, 0.5F)),
                NoisePictures::fill("contrast.extravasate", pictures_.noise(7, width, height, 0.0F, 0.5F)),
                NoisePictures::fill("contrast.capillary", pictures_.waves(width / 4, height / 4, 0.3F)),
                pass("composite", "contrast.composite", {{"tone", tone}, {"darkest", 0.12}})},
               {"final", "background", "contrast.summary", "contrast.reflux", "contrast.extravasate",
                "contrast.capillary"},
               {{"contrast.capillary", {{"scale", 0.25}}}});
        const Buffer blush = read("contrast.capillary");
        Buffer capillary(width, height);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                capillary.at(x, y) = reference::sample_linear(blush, capillary.uv(x, y));
            }
        }
        const std::vector<Buffer> layers{read("contrast.summary"), read("contrast.reflux"),
                                         read("contrast.extravasate"), capillary};
        const bool thesis = std::string_view(tone) == "thesis";
        expect(std::string("composite, five layers, ") + tone, "final",
               reference::composite(read("background"), layers, width, height,
                                    thesis ? reference::Tone::thesis : reference::Tone::beer_lambert,
                                    reference::extinction_for(0.12)));
    }
}

TEST_P(PictureAccuracy, CompositeOfOneLayerOverAPlainBackground) {
    render({NoisePictures::fill("contrast.reflux", pictures_.noise(8, width, height)),
            pass("composite", "contrast.composite", {{"darkest", 0.05}, {"background", 0.8}})},
           {"final", "contrast.reflux"});
    const std::vector<Buffer> layers{read("contrast.reflux")};
    expect("composite, one layer", "final",
           reference::composite(Buffer(1, 1, 1, 0.8), layers, width, height, reference::Tone::beer_lambert,
                                reference::extinction_for(0.05)));
}

// The blur's first direction is kept in full floats in both cases: what is measured is the pass, and not how
// a second one amplifies what the first one's target rounds off.
TEST_P(PictureAccuracy, GaussianOfTwoDirections) {
    constexpr double sigma = 0.05;
    for (const double gain : {0.9, 1.9}) {
        render({NoisePictures::fill("filter.source", pictures_.noise(9, width, height)),
                pass("x", "filter.gaussian", {{"axis", "x"}, {"sigma", sigma}}, {{"blurred", "half.way"}}),
                pass("y", "filter.gaussian", {{"axis", "y"}, {"sigma", sigma}, {"gain", gain}},
                     {{"source", "half.way"}})},
               {"filter.blurred", "filter.source"}, {{"half.way", {{"format", "r32f"}}}});
        expect("gaussian, gain " + std::to_string(gain), "filter.blurred",
               reference::capillary(read("filter.source"), sigma * height, gain));
    }
}

TEST_P(PictureAccuracy, GaussianOfAPictureOfAnotherSize) {
    render({NoisePictures::fill("filter.source", pictures_.noise(9, width, height)),
            pass("x", "filter.gaussian", {{"sigma", 0.0}, {"gain", 0.9}})},
           {"filter.blurred", "filter.source"}, {{"filter.source", {{"scale", 0.5}}}});
    const Buffer source = read("filter.source");
    Buffer wanted(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            wanted.at(x, y) = 0.9 * reference::sample_linear(source, wanted.uv(x, y));
        }
    }
    expect("gaussian, twice as large", "filter.blurred", wanted);
}

TEST_P(PictureAccuracy, ImageCoversTheTarget) {
    const std::string file = pictures_.waves(80, 80, 0.15F);
    render({pass("image", "picture.image", {{"file", file}, {"fit", "cover"}, {"gain", 0.7}})},
           {"background"});
    const Buffer source = to_buffer(io::read_exr(file).front().image);
    Buffer wanted(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            // The target is wider than the picture: all of its width shows, and the middle of its height.
            const glm::dvec2 uv = wanted.uv(x, y);
            const double v = (uv.y - 0.5) * height / width + 0.5;
            wanted.at(x, y) = 0.7 * reference::sample_linear(source, {uv.x, v});
        }
    }
    expect("image, cover", "background", wanted);
}

TEST(DistanceView, ShowsTheMapInColours) {
    const NoisePictures pictures;
    Stage stage;
    json scene = scene_of(tube_camera(),
                          {NoisePictures::fill("contrast.distance", pictures.noise(3, width, height, -1.0F)),
                           pass("view", "contrast.distance_view")},
                          {"contrast.distance_view", "contrast.distance"}, width, height);
    use_floats(scene, {"contrast.distance"});
    stage.load(scene);
    stage.render(0.0);
    const Image view = stage.renderer().read("contrast.distance_view");
    const Image map = stage.renderer().read("contrast.distance");
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float q = map.at(x, y, 0);
            ASSERT_EQ(view.at(x, y, 0), 0.0F);
            ASSERT_EQ(view.at(x, y, 1), q < 0.0F ? 0.0F : 1.0F);
            ASSERT_NEAR(view.at(x, y, 2), std::max(q, 0.0F), 0.5F / 255.0F + 1e-6F);
            ASSERT_EQ(view.at(x, y, 3), 1.0F);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Targets, PictureAccuracy, testing::Values(true, false),
                         [](const auto& info) { return info.param ? "float32" : "half"; });

}  // namespace
}  // namespace viscera::test

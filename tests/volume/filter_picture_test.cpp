#include <gtest/gtest.h>

#include "tests/volume/filter_kinds.h"
#include "tests/volume/mixed_scene.h"

namespace viscera::test {
namespace {

class FilterPicture : public testing::Test {
  protected:
    [[nodiscard]] Image shot(const LiveVolume& volume, const nlohmann::json& sampling,
                             const std::string& storage = "automatic") {
        nlohmann::json parameters{{"transfer_function", shell_function()}, {"sampling", sampling}};
        parameters["volume"]["storage"] = storage;
        // The nearest entry of a table would make steps of the last digit.
        parameters["transfer_function"]["interpolate"] = true;
        return mixed_shot(
            stage_, mixed_scene(nlohmann::json::array(), parameters, camera_at({250, -380, 120})), volume);
    }
    Stage stage_;
};

const std::vector<std::string>& filters() {
    static const std::vector<std::string> names{"nearest",      "linear",      "linear_fp32",     "bspline",
                                                "bspline_fp32", "catmull_rom", "catmull_rom_fp32"};
    return names;
}

/// Single bright voxels in the dark: filters that overshoot or reach far show it beside them.
Volume sparks() {
    std::mt19937 random(3);
    return byte_volume(32, 6.0, [&](const glm::dvec3&) { return random() % 300 == 0 ? 250.0 : 15.0; });
}

TEST_F(FilterPicture, SkippingChangesNoBit) {
    const LiveVolume volume(sparks());
    for (const std::string& filter : filters()) {
        for (const bool prefilter : {true, false}) {
            if (!prefilter && filter.find("bspline") == std::string::npos) {
                continue;
            }
            nlohmann::json sampling{{"filter", filter}, {"prefilter", prefilter}, {"skip", false}};
            const Image whole = shot(volume, sampling);
            sampling["skip"] = true;
            const Difference d = difference(whole, shot(volume, sampling));
            EXPECT_EQ(d.max, 0.0) << filter << " " << prefilter;
            EXPECT_GT(d.seen, 200U) << filter;
        }
    }
}

TEST_F(FilterPicture, AtlasAndTextureGiveTheSame) {
    const LiveVolume volume(shell_volume());
    for (const std::string& filter : filters()) {
        const nlohmann::json sampling{{"filter", filter}};
        const Difference d =
            difference(shot(volume, sampling, "texture_3d"), shot(volume, sampling, "atlas"));
        EXPECT_LE(d.max, 2e-5) << filter;
        EXPECT_GT(d.seen, 500U) << filter;
    }
    EXPECT_EQ(stage_.complaints(), std::vector<std::string>{});
}

TEST_F(FilterPicture, VolumesBeyondTheLimitOf3dTexturesAreDrawn) {
    for (const glm::ivec3 dims : {glm::ivec3(4100, 3, 2), glm::ivec3(3, 2, 4100)}) {
        Volume volume{.grid = {.dims = dims}, .voxels = {}, .source = "long"};
        volume.grid.spacing_mm = 200.0 / glm::dvec3(dims);
        volume.grid.origin_mm = glm::dvec3(-100.0) + 0.5 * volume.grid.spacing_mm;
        volume.voxels.resize(volume.grid.voxel_count(), std::byte{150});
        const LiveVolume live(std::move(volume));
        const nlohmann::json sampling{{"step", 20.0}};
        const Image image = shot(live, sampling);
        // A constant: the same box of two voxels a side shows it as well.
        Volume small{.grid = {.dims = glm::ivec3(2)}, .voxels = {}, .source = "small"};
        small.grid.spacing_mm = glm::dvec3(100.0);
        small.grid.origin_mm = glm::dvec3(-50.0);
        small.voxels.resize(8, std::byte{150});
        const LiveVolume same(std::move(small));
        const Difference d = difference(image, shot(same, {{"step", 0.02}}));
        EXPECT_LE(d.max, 2e-4);
        EXPECT_GT(d.seen, 500U);
    }
    EXPECT_EQ(stage_.complaints(), std::vector<std::string>{});
}

}  // namespace
}  // namespace viscera::test

// X-rays of white noise against the exact integral of the trilinear field, and what they cost.

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/core/error_of.h"
#include "tests/reference/volume_exact.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

constexpr int xray_voxels = 64;
constexpr double water_attenuation = 0.02;  // of value 0 (water) [1/mm]

/// Counts samples into red; green is the length of the path [mm].
ShaderTexts counting() {
    constexpr std::array<std::string_view, 1> sample{"sample_volume"};
    constexpr std::array<std::string_view, 2> function{"take_slab", "finish"};
    return {
        {"volume/filter_linear_fp32.glsl",
         wrapped(
             "volume/filter_linear_fp32.glsl", sample,
             "int samples_taken = 0;\n"
             "float sample_volume(vec3 place) { ++samples_taken; return plain_sample_volume(place); }\n")},
        {"volume/function_projection.glsl",
         wrapped("volume/function_projection.glsl", function,
                 "float path_mm = 0.0;\n"
                 "bool take_slab(inout State state, Slab slab) {\n"
                 "    path_mm += slab.length_mm;\n"
                 "    return plain_take_slab(state, slab);\n"
                 "}\n"
                 "vec4 finish(State state) { return vec4(float(samples_taken), path_mm, 0.0, 1.0); }\n")}};
}

nlohmann::json xray_parameters() {
    return {{"function", "xray"},
            {"xray", {{"negative", false}, {"water_attenuation_per_mm", water_attenuation}}},
            {"sampling", {{"scheme", "cell"}, {"filter", "linear_fp32"}, {"termination", 0}}}};
}

/// White noise from 0 to 1000 HU.
Volume noise() {
    Volume volume = noise_volume(glm::ivec3(xray_voxels), glm::dvec3(1.0), 11);
    volume.slope = 1000.0;
    return volume;
}

const std::array xray_looks{Look{.eye_mm = {90, -170, 60}, .fov_deg = 40},
                            Look{.eye_mm = {-120, -90, 140}, .orthographic_mm = 110},
                            Look{.eye_mm = {30, 12, -25}, .target_mm = {-30, -5, 20}, .fov_deg = 70}};

/// The optical depth itself: through the driver's exp, which is good to some 1e-6, and a logarithm it could
/// not be seen.
ShaderTexts bare() {
    constexpr std::array<std::string_view, 1> finish{"finish"};
    return {{"volume/function_projection.glsl",
             wrapped("volume/function_projection.glsl", finish,
                     "vec4 finish(State state) { return vec4(state.value, plain_finish(state).rgb); }\n")}};
}

TEST(XrayExact, WhiteNoiseIsTheExactTrilinearIntegral) {
    const LiveVolume volume(noise());
    const reference::Field field(volume.volume(), reference::Filter::trilinear);
    const reference::Medium medium = reference::ct_attenuation(water_attenuation);
    VolumeStage stage(bare());
    for (const Look& look : xray_looks) {
        const Shot shot = stage.cast(volume, xray_parameters(), look, glm::ivec2(48));
        double of_depth = 0.0;
        double of_box = 0.0;
        double of_intensity = 0.0;
        int seen = 0;
        for (int y = 0; y < shot.image.height; ++y) {
            for (int x = 0; x < shot.image.width; ++x) {
                const reference::Ray ray = shot.ray(x, y);
                const auto interval = reference::intersect(ray, field.texture_to_world(),
                                                           {.near_mm = shot.along(ray, look.near_mm)});
                if (!interval) {
                    continue;
                }
                const double depth = reference::optical_depth(field, ray, *interval, medium);
                const double error = std::abs(shot.at(x, y).x - depth);
                // A ray's place is known to some 2^-22 of the box: what cuts off a corner errs by that, not
                // by a share of its own short path.
                of_box = std::max(of_box, error / (water_attenuation * 1.5 * xray_voxels));
                if (interval->length() >= 0.5 * xray_voxels) {
                    of_depth = std::max(of_depth, error / depth);
                    of_intensity = std::max(of_intensity, std::abs(shot.at(x, y).y - std::exp(-depth)));
                    ++seen;
                }
            }
        }
        std::printf(
            "  X-ray: optical depth within %.2e of itself, %.2e of the box's, intensity within %.2e\n",
            of_depth, of_box, of_intensity);
        EXPECT_LE(of_depth, 2e-6);
        EXPECT_LE(of_box, 2e-6);
        EXPECT_LE(of_intensity, 2e-6);
        EXPECT_GT(seen, 400);
    }
    EXPECT_EQ(stage.stage().complaints(), std::vector<std::string>{});
}

TEST(XrayExact, AFilmShowsTheLineIntegralOverItsRange) {
    const LiveVolume volume(noise());
    VolumeStage stage(bare());
    nlohmann::json p = xray_parameters();
    for (const bool negative : {false, true}) {
        for (const auto& [from, to] : {std::pair(0.0, 3.0), std::pair(1.2, 2.2)}) {
            p["xray"]["film"] = {{"from", from}, {"to", to}};
            p["xray"]["negative"] = negative;
            p["xray"]["incident"] = 2.0;
            const Shot shot = stage.cast(volume, p, xray_looks[0], glm::ivec2(48));
            int between = 0;
            for (int y = 0; y < shot.image.height; ++y) {
                for (int x = 0; x < shot.image.width; ++x) {
                    if (shot.at(x, y) == glm::dvec4(0.0)) {
                        continue;  // beside the volume
                    }
                    const double absorbed = std::clamp((shot.at(x, y).x - from) / (to - from), 0.0, 1.0);
                    ASSERT_NEAR(shot.at(x, y).y, 2.0 * (negative ? absorbed : 1.0 - absorbed), 2e-6);
                    between += absorbed > 0.0 && absorbed < 1.0 ? 1 : 0;
                }
            }
            EXPECT_GT(between, 100);
        }
    }
    EXPECT_EQ(stage.stage().complaints(), std::vector<std::string>{});
    p["xray"]["film"] = {{"from", 2.0}, {"to", 2.0}};
    const auto error = error_of([&] { (void)stage.cast(volume, p, xray_looks[0], glm::ivec2(4)); });
    ASSERT_TRUE(error);
    EXPECT_NE(std::string(error->what()).find("/xray/film"), std::string::npos) << error->what();
}

TEST(XrayExact, TakesAtMostFourSamplesPerVoxelOfPath) {
    const LiveVolume volume(noise());
    VolumeStage stage(counting());
    for (const Look& look : xray_looks) {
        const Shot shot = stage.cast(volume, xray_parameters(), look, glm::ivec2(48));
        double samples = 0.0;
        double path = 0.0;
        double worst = 0.0;
        for (int y = 0; y < shot.image.height; ++y) {
            for (int x = 0; x < shot.image.width; ++x) {
                const glm::dvec4 c = shot.at(x, y);
                samples += c.x;
                path += c.y;
                // The cells at both ends are cut, but take as many samples as whole ones.
                worst = std::max(worst, c.y > 0.0 ? (c.x - 8.0) / c.y : 0.0);
            }
        }
        std::printf("  X-ray: %.2f samples per voxel of path, at most %.2f\n", samples / path, worst);
        EXPECT_GT(path, 10000.0);
        EXPECT_LE(samples / path, 4.0);
        EXPECT_LE(worst, 4.0);
        EXPECT_GE(samples / path, 2.0);
    }
}

}  // namespace
}  // namespace viscera::test

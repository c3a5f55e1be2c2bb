// What must not change the picture.

#include <cmath>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "tests/volume/mixed_scene.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

/// Without what makes steps of roundings: the nearest entry of a table, and a slab more or less before a ray
/// stops.
nlohmann::json look_of(std::string_view function, std::string_view scheme) {
    nlohmann::json transfer = shell_function();
    transfer["interpolate"] = true;
    return {{"function", function},
            {"transfer_function", transfer},
            {"sampling", {{"scheme", scheme}, {"filter", "linear_fp32"}, {"termination", 0}}}};
}

class Invariance : public testing::Test {
  protected:
    VolumeStage stage_;
    LiveVolume volume_{shell_volume(32, 4.0)};
    Look look_{.eye_mm = {190, -260, 120}, .fov_deg = 28};
};

TEST_F(Invariance, LengthsTimesAPowerOfTwoChangeNoBit) {
    for (const char* scheme : {"gauss", "cell", "midpoint"}) {
        nlohmann::json parameters = look_of("composite", scheme);
        parameters["transfer_function"]["reference_length_mm"] = 1.5;
        const Shot one = stage_.cast(volume_, parameters, look_);
        for (const double scale : {0.125, 64.0}) {
            Volume volume = volume_.volume();
            volume.grid.spacing_mm *= scale;
            volume.grid.origin_mm *= scale;
            const LiveVolume scaled(std::move(volume));
            parameters["transfer_function"]["reference_length_mm"] = 1.5 * scale;
            const Look look{.eye_mm = scale * look_.eye_mm,
                            .fov_deg = look_.fov_deg,
                            .near_mm = scale * look_.near_mm,
                            .far_mm = scale * look_.far_mm};
            EXPECT_TRUE(same_bits(one, stage_.cast(scaled, parameters, look))) << scheme << " " << scale;
        }
    }
}

TEST_F(Invariance, ATileIsAPartOfTheWhole) {
    // A field without edges: a tile's rays start from other roundings, 2^-24 of the box apart, and an edge of
    // one voxel makes 30 times that of the value.
    const LiveVolume smooth(float_volume(glm::ivec3(32), glm::dvec3(3.0), [](const glm::dvec3& p) {
        return 300.0 * std::exp(-glm::dot(p, p) / (2.0 * 20.0 * 20.0));
    }));
    for (const char* scheme : {"gauss", "cell"}) {
        const Shot whole = stage_.cast(smooth, look_of("composite", scheme), look_, glm::ivec2(96));
        const View view = whole.view;
        double worst = 0.0;
        for (int tile = 0; tile < 9; ++tile) {
            const int column = tile % 3;
            const int row = tile / 3;
            // The off-axis projection of a third of the picture each way.
            View part = view;
            part.projection =
                glm::translate(glm::dmat4(1.0), glm::dvec3(2.0 - 2.0 * column, 2.0 - 2.0 * row, 0.0)) *
                glm::scale(glm::dmat4(1.0), glm::dvec3(3.0, 3.0, 1.0)) * view.projection;
            const Shot shot = stage_.cast_again(smooth, part, glm::ivec2(32));
            for (int y = 0; y < 32; ++y) {
                for (int x = 0; x < 32; ++x) {
                    const glm::dvec4 d = glm::abs(shot.at(x, y) - whole.at(32 * column + x, 32 * row + y));
                    worst = std::max({worst, d.r, d.g, d.b, d.a});
                }
            }
        }
        std::printf("  tiles, %s: %.1e\n", scheme, worst);
        EXPECT_LE(worst, 1e-6);
    }
}

TEST_F(Invariance, QuarterTurnsOfVolumeAndCameraTogether) {
    for (const char* scheme : {"gauss", "cell"}) {
        nlohmann::json parameters = look_of("composite", scheme);
        const Shot still = stage_.cast(volume_, parameters, look_);
        for (int turns = 1; turns < 4; ++turns) {
            parameters["volume"]["placement"] = {{"rotate_deg", {0, 0, 90 * turns}}};
            Look look = look_;
            for (int i = 0; i < turns; ++i) {
                look.eye_mm = {-look.eye_mm.y, look.eye_mm.x, look.eye_mm.z};
            }
            const Shot turned = stage_.cast(volume_, parameters, look);
            const double worst = difference(still.image, turned.image).max;
            std::printf("  %d quarter turns, %s: %.1e\n", turns, scheme, worst);
            EXPECT_LE(worst, 1e-6);
        }
    }
}

TEST_F(Invariance, SourceAndDetectorOfAnXrayMayChangePlaces) {
    nlohmann::json parameters = look_of("xray", "cell");
    parameters["xray"] = {{"water_attenuation_per_mm", 0.004}};
    const Look there{.eye_mm = {190, -260, 120}, .orthographic_mm = 150};
    const Look back{.eye_mm = -there.eye_mm, .orthographic_mm = 150};
    const Shot a = stage_.cast(volume_, parameters, there);
    const Shot b = stage_.cast(volume_, parameters, back);
    double worst = 0.0;
    double most = 0.0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            worst = std::max(worst, std::abs(a.at(x, y).x - b.at(63 - x, y).x));
            most = std::max(most, a.at(x, y).x);
        }
    }
    std::printf("  source and detector: %.1e\n", worst);
    EXPECT_LE(worst, 1e-6);
    EXPECT_GT(most, 0.3);
}

TEST_F(Invariance, StepVoxelsAndScaleDoNotChangeTheLook) {
    nlohmann::json parameters = look_of("composite", "gauss");
    parameters["sampling"]["step"] = 0.1;
    parameters["sampling"]["termination"] = 0;
    const Shot fine = stage_.cast(volume_, parameters, look_);
    double before = 1.0;
    for (const double step : {0.8, 0.4, 0.2}) {
        parameters["sampling"]["step"] = step;
        const double d = difference(fine.image, stage_.cast(volume_, parameters, look_).image).mean;
        std::printf("  step %.1f: mean difference %.1e\n", step, d);
        EXPECT_LT(d, 0.6 * before);
        before = d;
    }
    EXPECT_LE(before, 2e-3);
    // The same homogeneous box of other voxels, and put together by the placement's scale.
    const auto box = [&](const glm::ivec3& dims, const nlohmann::json& placement) {
        const LiveVolume even(
            float_volume(dims, glm::dvec3(96.0) / glm::dvec3(dims), [](const glm::dvec3&) { return 150.0; }));
        nlohmann::json p = look_of("composite", "gauss");
        p["sampling"]["termination"] = 0;
        p["volume"]["placement"] = placement;
        return stage_.cast(even, p, look_);
    };
    const Shot even = box(glm::ivec3(16), nlohmann::json::object());
    EXPECT_LE(difference(even.image, box({4, 16, 48}, nlohmann::json::object()).image).max, 5e-6);
    const LiveVolume half(
        float_volume(glm::ivec3(16), glm::dvec3(3.0), [](const glm::dvec3&) { return 150.0; }));
    nlohmann::json p = look_of("composite", "gauss");
    p["sampling"]["termination"] = 0;
    p["volume"]["placement"] = {{"scale", {2, 2, 2}}};
    EXPECT_LE(difference(even.image, stage_.cast(half, p, look_).image).max, 5e-6);
}

TEST_F(Invariance, JitterIsReproducibleAndItsSeedsDiffer) {
    for (const char* jitter : {"hash", "blue_noise"}) {
        nlohmann::json parameters = look_of("composite", "gauss");
        parameters["sampling"]["jitter"] = jitter;
        parameters["sampling"]["seed"] = 4;
        const Shot first = stage_.cast(volume_, parameters, look_);
        VolumeStage other;
        EXPECT_TRUE(same_bits(first, other.cast(volume_, parameters, look_))) << jitter;
        parameters["sampling"]["seed"] = 5;
        EXPECT_FALSE(same_bits(first, stage_.cast(volume_, parameters, look_))) << jitter;
    }
}

}  // namespace
}  // namespace viscera::test

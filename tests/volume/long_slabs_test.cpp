// Long slabs where the transfer function hardly changes: fewer samples, and an error within the tolerance.

#include <array>

#include <gtest/gtest.h>

#include "tests/volume/mixed_scene.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

class LongSlabs : public testing::Test {
  protected:
    static nlohmann::json parameters(std::string_view scheme, double step, double tolerance,
                                     const nlohmann::json& points) {
        return {{"transfer_function", {{"points", points}}},
                {"sampling",
                 {{"scheme", scheme}, {"step", step}, {"tolerance", tolerance}, {"termination", 0.0}}}};
    }
    static double slabs(const LiveVolume& volume, const nlohmann::json& parameters, const Look& look) {
        VolumeStage stage(slab_counting());
        const Shot shot = stage.cast(volume, parameters, look);
        double sum = 0.0;
        for (int i = 0; i < 64 * 64; ++i) {
            sum += shot.at(i % 64, i / 64).x;
        }
        return sum;
    }

    VolumeStage stage_;
    Look look_{.eye_mm = {220, -480, 120}, .fov_deg = 30};
};

TEST_F(LongSlabs, TakeAConstantBodyAtOnceAndExactly) {
    const LiveVolume ball(float_volume(glm::ivec3(96), glm::dvec3(2.0), [](const glm::dvec3& p) {
        return std::clamp((72.0 - glm::length(p)) / 2.0 + 0.5, 0.0, 1.0);
    }));
    const nlohmann::json points{{{"value", 0.0}, {"opacity", 0.0}, {"colour", {0.2, 0.5, 0.9}}},
                                {{"value", 1.0}, {"opacity", 0.01}, {"colour", {0.9, 0.6, 0.4}}}};
    for (const char* scheme : {"midpoint", "gauss", "preintegrated"}) {
        const nlohmann::json plain = parameters(scheme, 0.25, 0.0, points);
        const nlohmann::json with = parameters(scheme, 0.25, 0.05, points);
        EXPECT_LE(difference(stage_.cast(ball, plain, look_).image, stage_.cast(ball, with, look_).image).max,
                  3e-6)
            << scheme;
        const double all = slabs(ball, plain, look_);
        const double few = slabs(ball, with, look_);
        std::printf("  %s: %.2f of the slabs\n", scheme, few / all);
        EXPECT_LT(few, 0.65 * all) << scheme;
    }
}

TEST_F(LongSlabs, StayWithinTheToleranceInNoise) {
    const LiveVolume head(head_volume(96, 240.0));
    const nlohmann::json points{{{"value", -1000}, {"opacity", 0.0}, {"colour", {0.7, 0.4, 0.3}}},
                                {{"value", -100}, {"opacity", 0.004}, {"colour", {0.8, 0.45, 0.35}}},
                                {{"value", 300}, {"opacity", 0.006}, {"colour", {0.9, 0.6, 0.5}}},
                                {{"value", 900}, {"opacity", 0.3}, {"colour", {1.0, 0.95, 0.85}}}};
    for (const double step : {0.25, 1.0, 3.0}) {
        const Shot plain = stage_.cast(head, parameters("midpoint", step, 0.0, points), look_);
        double before = slabs(head, parameters("midpoint", step, 0.0, points), look_);
        for (const double tolerance : {0.02, 0.1, 0.5}) {
            const nlohmann::json with = parameters("midpoint", step, tolerance, points);
            const double off = difference(plain.image, stage_.cast(head, with, look_).image).max;
            const double taken = slabs(head, with, look_);
            std::printf("  step %.2f, tolerance %.2f: off by %.1e, %.0f slabs\n", step, tolerance, off,
                        taken);
            EXPECT_LE(off, tolerance);
            EXPECT_LE(taken, before);
            before = taken;
        }
    }
}

TEST_F(LongSlabs, AreNotTakenWhereNothingIsSmooth) {
    const LiveVolume noise(noise_volume(glm::ivec3(24), glm::dvec3(4.0), 3));
    const nlohmann::json points{{{"value", 0.0}, {"opacity", 0.0}}, {{"value", 1.0}, {"opacity", 0.1}}};
    const Shot plain = stage_.cast(noise, parameters("gauss", 0.5, 0.0, points), look_);
    const Shot with = stage_.cast(noise, parameters("gauss", 0.5, 0.1, points), look_);
    EXPECT_TRUE(same_bits(plain, with)) << difference(plain.image, with.image).max;
}

}  // namespace
}  // namespace viscera::test

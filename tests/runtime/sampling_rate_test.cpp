#include "engine/runtime/sampling_rate.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.h"

namespace viscera::test {
namespace {

constexpr double target_ms = 33.0;
constexpr Quality default_minimum = SamplingRateOptions{}.minimum;

/// A renderer whose frames take base + full * samples, times noise.
struct Simulation {
    double base_ms = 3.0;
    double full_ms = 150.0;
    double noise = 0.0;  ///< largest deviation, as a share
    std::function<double(const Quality&)> samples = share_of;

    SamplingRateManager manager{{.target_ms = target_ms}};
    std::mt19937 random{7};
    Quality quality{};
    double last_ms = 0.0;  ///< 0: nothing was drawn

    /// One frame; its time.
    double frame(bool moved, double factor = 1.0) {
        FrameObservation seen{.interval_ms = std::max(last_ms, 16.0), .moved = moved};
        if (last_ms > 0.0) {
            seen.draw_ms = last_ms;
        }
        const Quality before = quality;
        quality = manager.next(seen);
        const bool drawn = moved || quality != before;
        std::uniform_real_distribution<double> deviation(1.0 - noise, 1.0 + noise);
        last_ms = drawn ? factor * (base_ms + full_ms * samples(quality)) * deviation(random) : 0.0;
        return last_ms;
    }
    std::vector<double> frames(int count, bool moved) {
        std::vector<double> times;
        for (int i = 0; i < count; ++i) {
            times.push_back(frame(moved));
        }
        return times;
    }
};

TEST(SamplingRate, ReachesTheTargetInThreeFramesWhateverTheLoad) {
    for (const double full_ms : {40.0, 80.0, 150.0, 300.0}) {
        Simulation scene{.full_ms = full_ms};
        scene.frames(2, true);
        for (const double time : scene.frames(50, true)) {
            EXPECT_LE(time, 1.1 * target_ms) << full_ms;
            EXPECT_GE(time, 0.7 * target_ms) << full_ms;
        }
    }
}

TEST(SamplingRate, SettlesOnOneQualityWithoutNoise) {
    for (const double base_ms : {0.0, 3.0, 15.0}) {
        Simulation scene{.base_ms = base_ms};
        scene.frames(8, true);
        const Quality settled = scene.quality;
        EXPECT_LT(share_of(settled), 1.0);
        for (int i = 0; i < 50; ++i) {
            scene.frame(true);
            EXPECT_EQ(scene.quality, settled) << base_ms << " ms, frame " << i;
        }
    }
}

TEST(SamplingRate, DoesNotSwingWithNoise) {
    Simulation scene{.noise = 0.1};
    scene.frames(8, true);
    int changes = 0;
    for (int i = 0; i < 300; ++i) {
        const Quality before = scene.quality;
        const double time = scene.frame(true);
        changes += scene.quality == before ? 0 : 1;
        EXPECT_LE(time, 1.25 * target_ms);
        EXPECT_GE(time, 0.6 * target_ms);
    }
    EXPECT_LE(changes, 6);
}

TEST(SamplingRate, OneSlowFrameChangesNothing) {
    Simulation scene;
    scene.frames(10, true);
    const Quality settled = scene.quality;
    scene.frame(true, 12.0);
    for (int i = 0; i < 10; ++i) {
        scene.frame(true);
        EXPECT_EQ(scene.quality, settled);
    }
}

TEST(SamplingRate, FollowsAChangeOfLoad) {
    Simulation scene{.full_ms = 70.0};
    scene.frames(10, true);
    scene.full_ms *= 4.0;
    scene.frames(3, true);
    EXPECT_LE(scene.frame(true), 1.1 * target_ms);
    scene.full_ms /= 4.0;
    scene.frames(7, true);
    EXPECT_GE(scene.frame(true), 0.7 * target_ms);
    EXPECT_LE(scene.frame(true), 1.1 * target_ms);
}

TEST(SamplingRate, ReturnsToFullQualityBySmallSteps) {
    Simulation scene{.full_ms = 280.0};
    scene.frames(10, true);
    double share = share_of(scene.quality);
    EXPECT_LT(share, 0.2);
    double waited_ms = 0.0;
    int refined = 0;
    while (!scene.quality.full() && refined < 100) {
        waited_ms += std::max(scene.last_ms, 16.0);
        const Quality before = scene.quality;
        scene.frame(false);
        if (waited_ms < SamplingRateOptions{}.delay_ms) {
            EXPECT_EQ(scene.quality, before) << "before the delay was over";
            continue;
        }
        ++refined;
        EXPECT_GE(scene.quality.resolution, before.resolution);
        EXPECT_LE(share_of(scene.quality), 2.0 * share * 1.000001);
        share = share_of(scene.quality);
    }
    EXPECT_LE(refined, 6);
    scene.frames(50, false);
    EXPECT_TRUE(scene.quality.full());
    EXPECT_EQ(scene.last_ms, 0.0) << "nothing is left to draw";
}

TEST(SamplingRate, MovingOnTakesUpTheQualityItHad) {
    Simulation scene;
    scene.frames(10, true);
    const Quality moving = scene.quality;
    scene.frames(60, false);
    ASSERT_TRUE(scene.quality.full());
    EXPECT_LE(scene.frame(true), 1.1 * target_ms);
    EXPECT_NEAR(share_of(scene.quality), share_of(moving), 0.3 * share_of(moving));
    for (const double time : scene.frames(20, true)) {
        EXPECT_LE(time, 1.25 * target_ms);
    }
}

TEST(SamplingRate, AFastRendererIsLeftAlone) {
    Simulation scene{.full_ms = 20.0, .noise = 0.2};
    for (int i = 0; i < 100; ++i) {
        scene.frame(i % 3 != 0);
        EXPECT_TRUE(scene.quality.full());
    }
}

TEST(SamplingRate, NothingIsWorseThanTheMinimum) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> exponent(-3.0, 6.0);
    for (const Quality minimum : {default_minimum, Quality{1.0, 0.3}, Quality{6.0, 1.0}, Quality{1.0, 1.0}}) {
        SamplingRateManager manager({.target_ms = target_ms, .minimum = minimum});
        double before = 1.0;
        for (int i = 0; i < 2000; ++i) {
            const Quality quality = manager.next({.draw_ms = std::pow(10.0, exponent(random)),
                                                  .interval_ms = 20.0,
                                                  .moved = random() % 4 != 0});
            EXPECT_GE(quality.step_factor, 1.0);
            EXPECT_LE(quality.step_factor, minimum.step_factor);
            EXPECT_GE(quality.resolution, minimum.resolution);
            EXPECT_LE(quality.resolution, 1.0);
            EXPECT_LE(share_of(quality), 2.0 * before * 1.000001);
            before = share_of(quality);
        }
    }
}

TEST(SamplingRate, RenderersThatHeedResolutionAlone) {
    Simulation scene{.full_ms = 100.0,
                     .samples = [](const Quality& q) { return q.resolution * q.resolution; }};
    scene.frames(10, true);
    for (const double time : scene.frames(50, true)) {
        EXPECT_LE(time, 1.25 * target_ms);
    }
}

TEST(SamplingRate, TimesThatAreNoneAreLeftOut) {
    Simulation scene;
    scene.frames(10, true);
    const Quality settled = scene.quality;
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 0.0, -5.0}) {
        EXPECT_EQ(scene.manager.next({.draw_ms = bad, .interval_ms = bad, .moved = true}), settled);
        EXPECT_EQ(scene.manager.next({.draw_ms = bad, .interval_ms = bad, .moved = false}), settled);
    }
}

TEST(SamplingRate, OptionsOutOfRangeAreRefused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const SamplingRateOptions& options :
         {SamplingRateOptions{.target_ms = 0.0}, SamplingRateOptions{.target_ms = nan},
          SamplingRateOptions{.delay_ms = -1.0}, SamplingRateOptions{.minimum = {0.5, 0.5}},
          SamplingRateOptions{.minimum = {2.0, 0.0}}, SamplingRateOptions{.minimum = {2.0, 1.5}},
          SamplingRateOptions{.minimum = {nan, nan}}}) {
        EXPECT_THROW(SamplingRateManager{options}, Error);
    }
}

TEST(SamplingRate, SharesAreWhatQualitiesTake) {
    for (double share = share_of(default_minimum); share <= 1.0; share *= 1.01) {
        const Quality quality = quality_for(share, default_minimum);
        EXPECT_NEAR(share_of(quality), share, 1e-9);
        EXPECT_EQ(quality.resolution * 16.0, std::round(quality.resolution * 16.0));
        EXPECT_LE(quality_for(std::min(1.0, 2.0 * share), default_minimum).resolution,
                  1.8 * quality.resolution);
    }
    EXPECT_TRUE(quality_for(1.0, default_minimum).full());
}

}  // namespace
}  // namespace viscera::test

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "effects/tissue/jets.h"

// A jet of blood in the air: its volume, what holds it together near the wound, and the drops that come of
// it.
namespace viscera::tissue {
namespace {

constexpr double dt_s = 1.0 / 120.0;
constexpr glm::dvec3 gravity_mm_s2{0.0, 0.0, -9806.65};

/// What a jet has let go after so many steps, over nothing that it could meet.
Jets spurt(const WoundParams& wound, int steps) {
    Jets jets;
    jets.clear();
    DropMeter meter;
    std::vector<DropSpawn> hits;
    for (int i = 0; i < steps; ++i) {
        jets.leave(wound, {0.5F, 0.5F}, meter.flow(wound.rate_mm3_s * dt_s, 0.125), 1.0, dt_s);
        jets.step(TriangleTree(), gravity_mm_s2, dt_s, hits);
    }
    EXPECT_TRUE(hits.empty());
    return jets;
}

WoundParams artery() {
    return {
        .rate_mm3_s = 220.0, .kind = BleedingKind::jet, .direction = {1.0, 0.0, 0.5}, .speed_mm_s = 620.0};
}

TEST(Jets, DropsDifferInSizeAndKeepTheVolume) {
    const Jets jets = spurt(artery(), 60);
    std::vector<double> volumes;
    for (const JetParticle& particle : jets.particles()) {
        volumes.push_back(particle.volume_mm3);
    }
    std::ranges::sort(volumes);
    ASSERT_GT(volumes.size(), 300U);
    const double most_left = 8.0 * 0.5;  // in whole drops
    EXPECT_NEAR(jets.flying_mm3(), 220.0 * 60.0 * dt_s, most_left);
    EXPECT_EQ(jets.lost_mm3(), 0.0);
    const auto quantile = [&](double q) {
        return volumes[static_cast<std::size_t>(q * static_cast<double>(volumes.size() - 1))];
    };
    std::printf("  %zu drops of %.3f to %.3f mm^3, the middle one %.3f\n", volumes.size(), quantile(0.05),
                quantile(0.95), quantile(0.5));
    EXPECT_GT(quantile(0.95) / quantile(0.05), 6.0);
}

TEST(Jets, AStreamHangsTogetherUntilItBreaksUp) {
    const WoundParams wound = artery();
    const Jets jets = spurt(wound, 30);
    const double breakup = breakup_time_s(wound.rate_mm3_s, wound.speed_mm_s);
    std::vector<JetParticle> stream(jets.particles().begin(), jets.particles().end());
    std::ranges::sort(stream, {}, &JetParticle::age_s);
    int young = 0;
    int old = 0;
    for (std::size_t i = 0; i + 1 < stream.size(); ++i) {
        const double apart = glm::distance(stream[i].position_mm, stream[i + 1].position_mm);
        const double speed = glm::length(stream[i].velocity_mm_s);
        const double covered = 0.5 * speed * (thread_s(stream[i]) + thread_s(stream[i + 1]));
        if (stream[i + 1].age_s < 0.5 * breakup) {
            // No gap as wide as the stream.
            EXPECT_LT(apart - covered,
                      std::sqrt(4.0 / std::numbers::pi * wound.rate_mm3_s / wound.speed_mm_s));
            ++young;
        } else if (stream[i].age_s > 2.0 * breakup) {
            EXPECT_EQ(covered, 0.0);
            ++old;
        }
    }
    EXPECT_GT(young, 5);
    EXPECT_GT(old, 50);
}

TEST(Jets, BreakUpAsWeberFound) {
    // Water-like blood from 1 mm at 1 m/s: 57 ms, that is 57 diameters.
    constexpr double rate = std::numbers::pi / 4.0 * 1000.0;
    EXPECT_NEAR(breakup_time_s(rate, 1000.0), 13.0 * std::sqrt(1060.0 * 1e-9 / 0.055), 1e-4);
    // It goes with the diameter to the power of 3/2.
    EXPECT_NEAR(breakup_time_s(4.0 * rate, 1000.0) / breakup_time_s(rate, 1000.0), std::pow(2.0, 1.5), 1e-12);
    EXPECT_EQ(breakup_time_s(rate, 0.0), 0.0);
    EXPECT_EQ(breakup_time_s(0.0, 1000.0), 0.0);
}

TEST(Jets, FlyOnParabolas) {
    const Jets jets = spurt(artery(), 40);
    for (const JetParticle& particle : jets.particles()) {
        // Back to where it left, by its own age.
        const double t = particle.age_s;
        const glm::dvec3 start =
            particle.position_mm - t * (particle.velocity_mm_s - 0.5 * t * gravity_mm_s2);
        EXPECT_LT(glm::length(start), 0.2 + 1e-9);
    }
}

/// A square wall at x, of 40 mm a side.
MeshData wall_at(float x) {
    MeshData mesh;
    for (const glm::vec2 corner :
         {glm::vec2(-20, -20), glm::vec2(20, -20), glm::vec2(20, 20), glm::vec2(-20, 20)}) {
        mesh.positions.emplace_back(x, corner);
        mesh.uvs.push_back(0.5F + corner / 50.0F);
    }
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

TEST(Jets, StartAtTheirWound) {
    WoundParams wound = artery();
    wound.direction = {1.0, 0.0, 0.0};
    Jets jets;
    jets.clear();
    std::vector<DropSpawn> hits;
    jets.leave(wound, {0.5F, 0.5F}, {8, 0.2}, 1.0, dt_s);
    jets.step(TriangleTree(), glm::dvec3(0.0), dt_s, hits);
    // One after the other through the step, the last one at its end: a stream from the wound on.
    double first = 1e9;
    double last = 0.0;
    ASSERT_EQ(jets.particles().size(), 8U);
    for (const JetParticle& particle : jets.particles()) {
        EXPECT_GE(particle.age_s, 0.0);
        EXPECT_LT(particle.age_s, dt_s);
        EXPECT_NEAR(particle.position_mm.x, 0.2 + particle.age_s * particle.velocity_mm_s.x, 1e-9);
        first = std::min(first, particle.position_mm.x);
        last = std::max(last, particle.position_mm.x);
    }
    std::printf("  from %.2f to %.2f mm after a step of %.2f mm\n", first, last, wound.speed_mm_s * dt_s);
    EXPECT_LT(first, 0.2 + 0.2 * wound.speed_mm_s * dt_s);
    EXPECT_LT(last, 0.2 + 1.1 * wound.speed_mm_s * dt_s);
}

TEST(Jets, MeetAWallRightBeforeTheirWound) {
    WoundParams wound = artery();
    wound.direction = {1.0, 0.0, 0.0};
    Jets jets;
    jets.clear();
    std::vector<DropSpawn> hits;
    const TriangleTree wall(wall_at(1.0F), glm::dmat4(1.0));
    double landed = 0.0;
    for (int i = 0; i < 3; ++i) {
        jets.leave(wound, {0.5F, 0.5F}, {8, 0.2}, 1.0, dt_s);
        jets.step(wall, gravity_mm_s2, dt_s, hits);
        for (const JetParticle& particle : jets.particles()) {
            EXPECT_LT(particle.position_mm.x, 1.0);
        }
    }
    for (const DropSpawn& drop : hits) {
        landed += static_cast<double>(drop.volume_mm3);
    }
    EXPECT_GT(landed, 2.0 * 8 * 0.2);
    EXPECT_NEAR(landed + jets.flying_mm3(), 3 * 8 * 0.2, 1e-5);
}

TEST(Jets, WhatIsLeftInTheMeterOfAClosedWoundIsADrop) {
    WoundParams wound = artery();
    wound.rate_mm3_s = 0.0;
    Jets jets;
    jets.clear();
    std::vector<DropSpawn> hits;
    jets.leave(wound, {0.5F, 0.5F}, {1, 0.2}, 1.0, dt_s);
    jets.step(TriangleTree(), gravity_mm_s2, dt_s, hits);
    ASSERT_EQ(jets.particles().size(), 1U);
    EXPECT_EQ(thread_s(jets.particles()[0]), 0.0);
    EXPECT_TRUE(std::isfinite(glm::length(jets.particles()[0].position_mm)));
}

TEST(Jets, WhatThereIsNoRoomForIsLostAndCounted) {
    Jets jets;
    jets.clear();
    std::vector<DropSpawn> hits;
    for (int i = 0; i < 600; ++i) {
        jets.leave(artery(), {0.5F, 0.5F}, {8, 0.2}, 1.0, 1e-4);
        jets.step(TriangleTree(), gravity_mm_s2, 1e-4, hits);
    }
    EXPECT_EQ(jets.particles().size(), Jets::most_particles);
    EXPECT_EQ(jets.refused(), 600 * 8 - Jets::most_particles);
    EXPECT_NEAR(jets.flying_mm3() + jets.lost_mm3(), 600 * 8 * 0.2, 1e-6);
    EXPECT_GT(jets.lost_mm3(), 0.0);
}

}  // namespace
}  // namespace viscera::tissue

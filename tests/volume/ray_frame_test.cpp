#include "effects/volume/ray_frame.h"

#include <random>

#include <gtest/gtest.h>

namespace viscera::volume {
namespace {

/// Rays that are level in the middle of the picture, and turn by so much towards its corners.
RayFrame frame_of(const glm::vec3& middle, const glm::vec3& per_x, const glm::vec3& per_y) {
    RayFrame frame;
    frame.direction = {middle, per_x, per_y};
    return frame;
}

std::size_t way_of(const glm::vec3& direction) {
    return (direction.x > 0.0F ? 1U : 0U) + (direction.y > 0.0F ? 2U : 0U) + (direction.z > 0.0F ? 4U : 0U);
}

TEST(WaysOf, hold_that_of_every_ray) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    const auto any = [&](float scale) { return scale * glm::vec3(unit(random), unit(random), unit(random)); };
    std::size_t held = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const float scale = std::exp2(40.0F * unit(random));
        const RayFrame frame = frame_of(any(scale), any(0.3F * scale), any(0.3F * scale));
        const Ways ways = ways_of(frame);
        held += ways.count();
        for (int i = 0; i < 50; ++i) {
            const glm::vec3 direction =
                frame.direction[0] + unit(random) * frame.direction[1] + unit(random) * frame.direction[2];
            ASSERT_TRUE(ways[way_of(direction)]) << "trial " << trial;
        }
    }
    EXPECT_LT(held, 2000U * 4U);  // and few others
}

TEST(WaysOf, are_one_where_no_ray_turns_back) {
    EXPECT_EQ(ways_of(frame_of({-3, 2, 1}, {1, 1, 0}, {0, 0.5F, 0.5F})), Ways(1U << 6U));
    EXPECT_EQ(ways_of(frame_of({0, 2, 0}, {1, 0, 0}, {0, 0, 1})).count(), 4U);
}

TEST(WaysOf, are_all_that_rounding_may_make_of_a_level_ray) {
    EXPECT_EQ(ways_of(frame_of({0, 0, 1}, glm::vec3(0), glm::vec3(0))).to_ulong(), 0b11110000U);
    EXPECT_EQ(ways_of(frame_of({1e-7F, 1, 1}, {0, 0.1F, 0}, {-1e-7F, 0, 0.1F})).count(), 2U);
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(ways_of(frame_of(glm::vec3(nan), glm::vec3(0), glm::vec3(0))).count(), 8U);
}

}  // namespace
}  // namespace viscera::volume

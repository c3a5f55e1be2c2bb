#include "effects/volume/brick_distances.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/pixel_index.h"
#include "tests/volume/cells.h"

namespace viscera::volume {
namespace {

/// Bricks of up to `count` kinds, most of them of kind 0 where `per_mille` is small.
std::vector<std::uint8_t> random_kinds(const glm::ivec3& dims, unsigned per_mille, unsigned count,
                                       std::mt19937& random) {
    std::vector<std::uint8_t> kinds(count_of(dims));
    for (std::uint8_t& brick : kinds) {
        brick = static_cast<std::uint8_t>(random() % 1000U < per_mille ? 1U + random() % (count - 1) : 0U);
    }
    return kinds;
}

constexpr std::array<glm::ivec3, 8> sizes{
    {{1, 1, 1}, {1, 9, 13}, {70, 1, 3}, {7, 66, 1}, {13, 11, 9}, {3, 2, 40}, {65, 6, 4}, {16, 5, 6}}};
constexpr std::array<unsigned, 6> shares{1U, 10U, 200U, 800U, 990U, 999U};

/// Distance to the nearest brick of another kind, all pairs.
std::vector<std::uint8_t> all_pairs(const glm::ivec3& dims, const std::vector<std::uint8_t>& kinds) {
    std::vector<std::uint8_t> distance(kinds.size());
    for_each(dims, [&](std::size_t i, const glm::ivec3& a) {
        int nearest = distance_reach;
        for_each(dims, [&](std::size_t j, const glm::ivec3& b) {
            if (kinds[j] != kinds[i]) {
                const glm::ivec3 apart = glm::abs(a - b);
                nearest = std::min(nearest, std::max({apart.x, apart.y, apart.z}));
            }
        });
        distance[i] = static_cast<std::uint8_t>(nearest);
    });
    return distance;
}

TEST(DistanceToOthers, is_that_of_all_pairs) {
    std::mt19937 random(11);
    DistanceScratch scratch;
    std::vector<std::uint8_t> distance;
    for (const glm::ivec3& dims : sizes) {
        for (const unsigned per_mille : shares) {
            const std::vector<std::uint8_t> kinds = random_kinds(dims, per_mille, 3, random);
            for (int kind = 0; kind < 3; ++kind) {
                distance_to_others(dims, kinds, kind, distance, scratch);
            }
            ASSERT_EQ(distance, all_pairs(dims, kinds))
                << dims.x << ' ' << dims.y << ' ' << dims.z << " at " << per_mille;
        }
    }
}

TEST(DistanceToOthers, leaves_those_of_other_kinds_alone) {
    DistanceScratch scratch;
    std::vector<std::uint8_t> distance{7, 7, 7};
    distance_to_others({3, 1, 1}, std::vector<std::uint8_t>{1, 0, 0}, 0, distance, scratch);
    EXPECT_EQ(distance, (std::vector<std::uint8_t>{7, 1, 2}));
}

TEST(DistanceToOthers, ends_at_its_reach) {
    const glm::ivec3 dims(100, 3, 2);
    std::vector<std::uint8_t> kinds(count_of(dims), 0);
    DistanceScratch scratch;
    std::vector<std::uint8_t> distance;
    distance_to_others(dims, kinds, 0, distance, scratch);
    EXPECT_THAT(distance, testing::Each(distance_reach));  // the outside does not limit it
    kinds[0] = 1;
    distance_to_others(dims, kinds, 0, distance, scratch);
    EXPECT_EQ(distance[30], 30);
    EXPECT_EQ(distance[31], 31);
    EXPECT_EQ(distance[32], 31);
    EXPECT_EQ(distance[99], 31);
}

TEST(DistanceToOthers, allocates_nothing_the_second_time) {
    const glm::ivec3 dims(20, 10, 10);
    const std::vector<std::uint8_t> kinds(count_of(dims), 1);
    DistanceScratch scratch;
    std::vector<std::uint8_t> distance;
    distance_to_others(dims, kinds, 1, distance, scratch);
    const auto where = [&] {
        return std::array<const void*, 3>{scratch.grid.data(), scratch.row.data(), distance.data()};
    };
    const auto before = where();
    distance_to_others(dims, kinds, 1, distance, scratch);
    EXPECT_EQ(where(), before);
}

TEST(DistanceToOthers, refuses_another_size) {
    DistanceScratch scratch;
    std::vector<std::uint8_t> distance;
    EXPECT_THROW(distance_to_others({2, 2, 2}, std::vector<std::uint8_t>(7), 0, distance, scratch), Error);
    EXPECT_NO_THROW(distance_to_others({0, 2, 2}, {}, 0, distance, scratch));
    EXPECT_TRUE(distance.empty());
}

/// The largest cube ahead of each brick that holds no other kind, tried brick by brick.
int size_by_trial(const glm::ivec3& dims, const std::vector<std::uint8_t>& kinds, const glm::ivec3& from,
                  const glm::ivec3& up) {
    const auto kind_at = [&](const glm::ivec3& b) { return kinds[voxel_index(b, dims)]; };
    int size = distance_reach;
    for_each(glm::ivec3(distance_reach), [&](std::size_t, const glm::ivec3& step) {
        const glm::ivec3 b = from + step * (2 * up - 1);
        const bool inside =
            glm::all(glm::greaterThanEqual(b, glm::ivec3(0))) && glm::all(glm::lessThan(b, dims));
        if (inside && kind_at(b) != kind_at(from)) {
            size = std::min(size, std::max({step.x, step.y, step.z}));
        }
    });
    return size;
}

std::uint8_t texel_of(CubesAhead& cubes, const glm::ivec3& dims, const glm::ivec3& brick,
                      const glm::ivec3& up) {
    return cubes.texels(glm::bvec3(up))[voxel_index(brick, dims)];
}

TEST(CubesAhead, are_those_tried_one_by_one) {
    std::mt19937 random(5);
    CubesAhead cubes;
    for (const glm::ivec3& dims : sizes) {
        for (const unsigned per_mille : shares) {
            const std::vector<std::uint8_t> kinds = random_kinds(dims, per_mille, 5, random);
            cubes.take(dims, kinds);
            for (int trial = 0; trial < 60; ++trial) {
                const glm::ivec3 up(random() % 2U, random() % 2U, random() % 2U);
                const glm::ivec3 b(random() % static_cast<unsigned>(dims.x),
                                   random() % static_cast<unsigned>(dims.y),
                                   random() % static_cast<unsigned>(dims.z));
                ASSERT_EQ(cubes.texels(glm::bvec3(up)).size(), kinds.size());
                const int texel = texel_of(cubes, dims, b, up);
                const int kind = kinds[voxel_index(b, dims)];
                ASSERT_EQ(texel / kind_step, kind);
                ASSERT_EQ(texel % kind_step, size_by_trial(dims, kinds, b, up))
                    << dims.x << ' ' << dims.y << ' ' << dims.z << " at " << per_mille << ", brick " << b.x
                    << ' ' << b.y << ' ' << b.z << ", up " << up.x << up.y << up.z;
            }
        }
    }
}

TEST(CubesAhead, take_no_notice_of_what_lies_behind) {
    const glm::ivec3 dims(40, 1, 1);
    std::vector<std::uint8_t> kinds(40, 0);
    kinds[19] = 1;
    CubesAhead cubes;
    cubes.take(dims, kinds);
    const auto size = [&](int x, int up) { return texel_of(cubes, dims, {x, 0, 0}, {up, 0, 0}); };
    EXPECT_EQ(size(20, 0), 1);               // down, towards the other one
    EXPECT_EQ(size(20, 1), distance_reach);  // up, away from it
    EXPECT_EQ(size(18, 0), distance_reach);
    EXPECT_EQ(size(18, 1), 1);
    EXPECT_EQ(size(19, 0), kind_step + 1);
}

TEST(CubesAhead, forget_what_they_were_of_before) {
    const glm::ivec3 dims(5, 1, 1);
    CubesAhead cubes;
    cubes.take(dims, std::vector<std::uint8_t>{0, 0, 0, 0, 1});
    EXPECT_EQ(texel_of(cubes, dims, {0, 0, 0}, {1, 0, 0}), 4);
    cubes.take(dims, std::vector<std::uint8_t>{0, 0, 1, 0, 0});
    EXPECT_EQ(texel_of(cubes, dims, {0, 0, 0}, {1, 0, 0}), 2);
}

TEST(CubesAhead, allocate_nothing_the_second_time) {
    const glm::ivec3 dims(20, 10, 10);
    const std::vector<std::uint8_t> kinds(count_of(dims), 1);
    CubesAhead cubes;
    cubes.take(dims, kinds);
    const auto* const before = cubes.texels({true, false, true}).data();
    cubes.take(dims, kinds);
    EXPECT_EQ(cubes.texels({false, false, true}).data(), before);
}

TEST(CubesAhead, refuse_another_size) {
    CubesAhead cubes;
    EXPECT_THROW(cubes.take({2, 2, 2}, std::vector<std::uint8_t>(7)), Error);
    EXPECT_NO_THROW(cubes.take({0, 2, 2}, {}));
    EXPECT_TRUE(cubes.texels({true, true, true}).empty());
}

}  // namespace
}  // namespace viscera::volume

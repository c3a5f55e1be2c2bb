#include "effects/volume/bricks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include "engine/core/error.h"
#include "tests/core/not_finite.h"
#include "tests/volume/cells.h"

namespace viscera::volume {
namespace {

template <typename T>
constexpr ScalarType scalar_type = ScalarType::f32;
template <>
constexpr ScalarType scalar_type<std::uint8_t> = ScalarType::u8;
template <>
constexpr ScalarType scalar_type<std::int8_t> = ScalarType::i8;
template <>
constexpr ScalarType scalar_type<std::uint16_t> = ScalarType::u16;
template <>
constexpr ScalarType scalar_type<std::int16_t> = ScalarType::i16;

template <typename T>
Volume volume_of(const glm::ivec3& dims, const std::vector<T>& values, int channels = 1) {
    Volume volume;
    volume.grid.dims = dims;
    volume.type = scalar_type<T>;
    volume.channels = channels;
    volume.voxels.resize(values.size() * sizeof(T));
    std::memcpy(volume.voxels.data(), values.data(), volume.voxels.size());
    volume.source = "test";
    return volume;
}

/// The whole range of the type, so that a comparison in the wrong type shows.
template <typename T>
std::vector<T> random_values(std::size_t count, std::uint_fast32_t seed) {
    std::mt19937 random(seed);
    std::vector<T> values(count);
    for (T& value : values) {
        if constexpr (std::is_floating_point_v<T>) {
            const std::array<float, 4> odd{nan_float, infinity_float, -infinity_float, -1e30F};
            const std::uint_fast32_t n = random();
            value = n % 8U < 4U ? odd[n % 4U] : static_cast<float>(static_cast<int>(random() % 2001U) - 1000);
        } else {
            value = static_cast<T>(random());
        }
    }
    return values;
}

/// Voxel by voxel.
template <typename T>
BrickGrid brute_force(const glm::ivec3& dims, const std::vector<T>& values, int channels, int channel,
                      int size, int border, float empty) {
    BrickGrid bricks{.dims = (dims + size - 1) / size, .size = size, .border = border};
    bricks.min.assign(count_of(bricks.dims), infinity_float);
    bricks.max.assign(count_of(bricks.dims), -infinity_float);
    for_each(bricks.dims, [&](std::size_t b, const glm::ivec3& brick) {
        for_each(glm::ivec3(size + 2 * border), [&](std::size_t, const glm::ivec3& offset) {
            const glm::ivec3 voxel = brick * size - border + offset;
            if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) ||
                glm::any(glm::greaterThanEqual(voxel, dims))) {
                return;
            }
            const int index = (voxel.x + dims.x * (voxel.y + dims.y * voxel.z)) * channels + channel;
            auto value = static_cast<float>(values[static_cast<std::size_t>(index)]);
            value = std::isfinite(value) ? value : empty;
            bricks.min[b] = std::min(bricks.min[b], value);
            bricks.max[b] = std::max(bricks.max[b], value);
        });
    });
    return bricks;
}

void expect_equal(const BrickGrid& bricks, const BrickGrid& expected) {
    EXPECT_EQ(bricks.dims, expected.dims);
    EXPECT_EQ(bricks.size, expected.size);
    EXPECT_EQ(bricks.border, expected.border);
    EXPECT_EQ(bricks.min, expected.min);
    EXPECT_EQ(bricks.max, expected.max);
}

constexpr std::array<glm::ivec3, 7> odd_sizes{
    {{1, 1, 1}, {1, 9, 13}, {17, 1, 5}, {7, 6, 1}, {13, 11, 9}, {4, 8, 12}, {3, 2, 21}}};

template <typename T>
class Ranges : public testing::Test {};
using Types = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, float>;
TYPED_TEST_SUITE(Ranges, Types);

TYPED_TEST(Ranges, are_those_of_each_voxel_and_border) {
    std::uint_fast32_t seed = 0;
    for (const glm::ivec3& dims : odd_sizes) {
        for (const int size : {1, 4, 5}) {
            for (const int border : {0, 1, 2}) {
                const auto values = random_values<TypeParam>(count_of(dims), ++seed);
                expect_equal(summarise(volume_of(dims, values), 0, size, border, -7.0F),
                             brute_force(dims, values, 1, 0, size, border, -7.0F));
            }
        }
    }
}

TYPED_TEST(Ranges, tell_channels_apart) {
    const glm::ivec3 dims(9, 5, 6);
    for (const int channels : {2, 3, 4}) {
        const auto values = random_values<TypeParam>(count_of(dims) * static_cast<std::size_t>(channels), 5);
        for (int channel = 0; channel < channels; ++channel) {
            expect_equal(summarise(volume_of(dims, values, channels), channel, 4, 1, 0.0F),
                         brute_force(dims, values, channels, channel, 4, 1, 0.0F));
        }
    }
}

TYPED_TEST(Ranges, made_again_after_a_change_are_those_made_anew) {
    std::mt19937 random(3);
    const glm::ivec3 dims(23, 14, 19);
    auto values = random_values<TypeParam>(count_of(dims), 1);
    const auto pick = [&](int below) { return static_cast<int>(random() % static_cast<unsigned>(below)); };
    for (const int border : {0, 1, 2}) {
        BrickGrid bricks = summarise(volume_of(dims, values), 0, 4, border, 0.0F);
        for (int change = 0; change < 20; ++change) {
            const VoxelBox box{{pick(dims.x), pick(dims.y), pick(dims.z)}, {pick(9), pick(9), pick(9)}};
            const auto fresh = random_values<TypeParam>(values.size(), random());
            for_each(dims, [&](std::size_t i, const glm::ivec3& voxel) {
                if (glm::all(glm::greaterThanEqual(voxel, box.first)) &&
                    glm::all(glm::lessThan(voxel, box.first + box.size))) {
                    values[i] = fresh[i];
                }
            });
            const BrickGrid before = bricks;
            const VoxelBox touched = resummarise(bricks, volume_of(dims, values), 0, 0.0F, box);
            expect_equal(bricks, brute_force(dims, values, 1, 0, 4, border, 0.0F));
            for_each(bricks.dims, [&](std::size_t i, const glm::ivec3& brick) {
                const bool inside = glm::all(glm::greaterThanEqual(brick, touched.first)) &&
                                    glm::all(glm::lessThan(brick, touched.first + touched.size));
                ASSERT_TRUE(inside || (bricks.min[i] == before.min[i] && bricks.max[i] == before.max[i]));
            });
        }
    }
}

TEST(Summary, a_change_makes_only_the_bricks_again_that_it_reaches) {
    const Volume volume = volume_of<std::uint8_t>({16, 16, 16}, std::vector<std::uint8_t>(4096));
    BrickGrid bricks = summarise(volume, 0, 4, 1, 0.0F);
    const auto touched = [&](const VoxelBox& box) { return resummarise(bricks, volume, 0, 0.0F, box); };
    EXPECT_EQ(touched({{5, 5, 5}, {2, 2, 2}}), (VoxelBox{{1, 1, 1}, {1, 1, 1}}));
    EXPECT_EQ(touched({{4, 5, 7}, {1, 1, 1}}), (VoxelBox{{0, 1, 1}, {2, 1, 2}}));
    EXPECT_EQ(touched({{-9, 14, -1}, {10, 90, 3}}), (VoxelBox{{0, 3, 0}, {1, 1, 1}}));
    EXPECT_EQ(touched({{16, 0, 0}, {4, 4, 4}}), VoxelBox{});
    EXPECT_EQ(touched({{3, 3, 3}, {0, 2, 2}}), VoxelBox{});
}

TEST(Summary, nan_and_infinite_voxels_count_as_empty) {
    const Volume volume = volume_of<float>({4, 1, 1}, {nan_float, infinity_float, -infinity_float, 5.0F});
    const BrickGrid bricks = summarise(volume, 0, 2, 0, -3.0F);
    EXPECT_THAT(bricks.min, testing::ElementsAre(-3.0F, -3.0F));
    EXPECT_THAT(bricks.max, testing::ElementsAre(-3.0F, 5.0F));
}

TEST(Summary, tells_its_progress_and_stops_when_told) {
    const Volume volume = volume_of<std::uint8_t>({4, 4, 20}, std::vector<std::uint8_t>(320));
    std::vector<double> told;
    (void)summarise(volume, 0, 4, 1, 0.0F, [&](double fraction) {
        told.push_back(fraction);
        return true;
    });
    EXPECT_THAT(told, testing::ElementsAre(0.2, 0.4, 0.6, 0.8, 1.0));
    int calls = 0;
    try {
        (void)summarise(volume, 0, 4, 1, 0.0F, [&](double) { return ++calls < 2; });
        FAIL() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage);
        EXPECT_EQ(error.message(), "cancelled");
    }
    EXPECT_EQ(calls, 2);
}

TEST(Summary, refuses_what_it_cannot_do) {
    const Volume volume = volume_of<std::uint8_t>({2, 2, 2}, std::vector<std::uint8_t>(8));
    EXPECT_THROW((void)summarise(volume, 1, 4, 1, 0.0F), Error);
    EXPECT_THROW((void)summarise(volume, -1, 4, 1, 0.0F), Error);
    EXPECT_THROW((void)summarise(volume, 0, 0, 1, 0.0F), Error);
    EXPECT_THROW((void)summarise(volume, 0, 4, -1, 0.0F), Error);
}

/// Bricks along x with given ranges.
BrickGrid line_of(std::vector<float> min, std::vector<float> max) {
    BrickGrid bricks{.dims = {static_cast<int>(min.size()), 1, 1}};
    bricks.min = std::move(min);
    bricks.max = std::move(max);
    return bricks;
}

TEST(Occupied, bricks_are_those_whose_range_meets_a_visible_one_ends_included) {
    const BrickGrid bricks = line_of({0, 10, 20, 21, 30, 41, 50}, {9, 10, 25, 29, 40, 49, 90});
    const std::array<StoredRange, 2> visible{{{10, 20}, {40, 40}}};
    std::vector<std::uint8_t> occupied;
    find_occupied(bricks, visible, {}, occupied);
    EXPECT_THAT(occupied, testing::ElementsAre(0, 1, 1, 0, 1, 0, 0));
    find_occupied(bricks, {}, {}, occupied);
    EXPECT_THAT(occupied, testing::Each(0));
}

TEST(Occupied, bricks_widen_where_the_filter_overshoots) {
    const BrickGrid bricks = line_of({0, 0, 110, 110}, {90, 90.0F, 210, 110});
    const std::array<StoredRange, 1> low{{{132.0F, 140.0F}}};
    const std::array<StoredRange, 1> high{{{50.0F, 63.0F}}};
    std::vector<std::uint8_t> occupied;
    find_occupied(bricks, low, {}, occupied);
    EXPECT_THAT(occupied, testing::ElementsAre(0, 0, 1, 0));
    find_occupied(bricks, low, {}, occupied, catmull_rom_overshoot);  // 90 + 0.4766 * 90 = 132.9
    EXPECT_THAT(occupied, testing::ElementsAre(1, 1, 1, 0));
    find_occupied(bricks, high, {}, occupied, catmull_rom_overshoot);  // 110 - 0.4766 * 100 = 62.3
    EXPECT_THAT(occupied, testing::ElementsAre(1, 1, 1, 0));
    find_occupied(bricks, high, {}, occupied);
    EXPECT_THAT(occupied, testing::ElementsAre(1, 1, 0, 0));
}

TEST(Occupied, catmull_rom_overshoot_is_reached_and_never_passed) {
    std::array<double, 4> halfway{};
    double most = 0.0;
    for (int i = 0; i <= 1000; ++i) {
        const double t = i / 1000.0;
        const std::array<double, 4> w{((-t + 2.0) * t - 1.0) * t / 2.0, ((3.0 * t - 5.0) * t * t + 2.0) / 2.0,
                                      ((-3.0 * t + 4.0) * t + 1.0) * t / 2.0, (t - 1.0) * t * t / 2.0};
        const double magnitude = std::abs(w[0]) + std::abs(w[1]) + std::abs(w[2]) + std::abs(w[3]);
        most = std::max(most, magnitude);
        halfway = i == 500 ? w : halfway;
    }
    EXPECT_DOUBLE_EQ(most, 1.25);
    // The voxels that lift the filter the most: 1 where the product of the weights is positive, else 0.
    double value = 0.0;
    for (const double x : halfway) {
        for (const double y : halfway) {
            for (const double z : halfway) {
                value += std::max(0.0, x * y * z);
            }
        }
    }
    EXPECT_DOUBLE_EQ(value, 1.0 + static_cast<double>(catmull_rom_overshoot));
}

TEST(Occupied, bricks_share_a_voxel_with_the_crop) {
    const Volume volume = volume_of<std::uint8_t>({10, 7, 9}, std::vector<std::uint8_t>(630, 50));
    const BrickGrid bricks = summarise(volume, 0, 4, 1, 0.0F);
    const std::array<StoredRange, 1> visible{{{50, 50}}};
    std::mt19937 random(9);
    const auto pick = [&](int low, int high) {
        return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
    };
    std::vector<std::uint8_t> occupied;
    for (int i = 0; i < 300; ++i) {
        const VoxelBox crop{{pick(-6, 9), pick(-6, 6), pick(-6, 8)}, {pick(1, 9), pick(1, 9), pick(1, 9)}};
        find_occupied(bricks, visible, crop, occupied);
        std::vector<std::uint8_t> expected(bricks.count());
        for_each(volume.grid.dims, [&](std::size_t, const glm::ivec3& voxel) {
            if (glm::all(glm::greaterThanEqual(voxel, crop.first)) &&
                glm::all(glm::lessThan(voxel, crop.first + crop.size))) {
                const glm::ivec3 b = voxel / 4;
                expected[static_cast<std::size_t>(b.x + 3 * (b.y + 2 * b.z))] = 1;
            }
        });
        ASSERT_EQ(occupied, expected);
    }
    find_occupied(bricks, visible, {{2, 2, 2}, {0, 0, 0}}, occupied);
    EXPECT_EQ(occupancy(occupied), 1.0);
    find_occupied(bricks, visible, {{2, 2, 2}, {3, 0, 3}}, occupied);
    EXPECT_EQ(occupancy(occupied), 0.0);
}

TEST(Occupancy, is_the_share_of_occupied_bricks) {
    EXPECT_EQ(occupancy(std::vector<std::uint8_t>{1, 0, 0, 1}), 0.5);
    EXPECT_EQ(occupancy({}), 0.0);
}

TEST(BrickSize, grows_where_there_would_be_too_many) {
    EXPECT_EQ(brick_size_for(glm::ivec3(1)), 3);
    EXPECT_EQ(brick_size_for(glm::ivec3(256)), 3);
    EXPECT_EQ(brick_size_for(glm::ivec3(512)), 4);
    EXPECT_EQ(brick_size_for(glm::ivec3(1024)), 8);
    EXPECT_EQ(brick_size_for({3072, 1, 1}), 3);
    EXPECT_EQ(brick_size_for({1, 1, 3073}), 4);
    EXPECT_EQ(brick_size_for({2, 100000, 2}), 98);
}

}  // namespace
}  // namespace viscera::volume

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/core/volume.h"

namespace viscera::test {
namespace {

using std::numbers::pi;

VolumeShape ring() {
    return {.kind = VolumeKind::cylindrical,
            .r_min_mm = 2.0,
            .r_max_mm = 30.0,
            .first_angle_rad = 0.3,
            .angle_rad = 2.0 * pi,
            .wrap = true,
            .height_mm = 50.0};
}

VolumeShape sector() {
    return {.kind = VolumeKind::spherical,
            .r_min_mm = 0.0,
            .r_max_mm = 30.0,
            .first_angle_rad = -1.0,
            .angle_rad = 2.0,
            .latitude_rad = pi};
}

/// Voxels of one f32 channel; `value` by curvilinear coordinates.
template <class Value>
Volume make_volume(const VolumeShape& shape, const glm::ivec3& dims, const Value& value) {
    const ShapeAxes axes = axes_of(shape, dims);
    std::vector<float> voxels;
    glm::ivec3 i;
    for (i.z = 0; i.z < dims.z; ++i.z) {
        for (i.y = 0; i.y < dims.y; ++i.y) {
            for (i.x = 0; i.x < dims.x; ++i.x) {
                voxels.push_back(static_cast<float>(value(axes.first + glm::dvec3(i) * axes.step)));
            }
        }
    }
    Volume volume{.grid = {.dims = dims, .shape = shape}, .type = ScalarType::f32, .voxels = {}};
    volume.voxels.resize(voxels.size() * sizeof(float));
    std::memcpy(volume.voxels.data(), voxels.data(), volume.voxels.size());
    return volume;
}

/// Calls visit(coordinates, stored) for each voxel.
template <class Visit>
void for_each(const Volume& volume, const Visit& visit) {
    const ShapeAxes axes = axes_of(volume.grid.shape, volume.grid.dims);
    glm::ivec3 i;
    for (i.z = 0; i.z < volume.grid.dims.z; ++i.z) {
        for (i.y = 0; i.y < volume.grid.dims.y; ++i.y) {
            for (i.x = 0; i.x < volume.grid.dims.x; ++i.x) {
                visit(axes.first + glm::dvec3(i) * axes.step, volume.stored(i));
            }
        }
    }
}

TEST(ReducedCurvilinear, KeepsTheShapeAndDividesItsExtents) {
    const Volume around = make_volume(ring(), {29, 37, 12}, [](const glm::dvec3&) { return 0.25; });
    const Volume part = make_volume(sector(), {37, 29, 1}, [](const glm::dvec3&) { return 0.25; });
    for (const int factor : {2, 3, 7, 64}) {
        const Volume a = reduced(around, factor);
        const Volume b = reduced(part, factor);
        EXPECT_EQ(a.grid.shape, around.grid.shape);
        EXPECT_EQ(b.grid.shape, part.grid.shape);
        a.validate();
        b.validate();
        EXPECT_EQ(a.grid.dims.x, std::max(1, 28 / factor) + 1);
        EXPECT_EQ(a.grid.dims.y, std::max(1L, std::lround(37.0 / factor)));
        EXPECT_EQ(b.grid.dims.x, std::max(1, 36 / factor) + 1);
        EXPECT_EQ(b.grid.dims.z, 1);
        for (const Volume* volume : {&a, &b}) {
            for_each(*volume, [](const glm::dvec3&, double value) { ASSERT_EQ(value, 0.25); });
        }
    }
}

TEST(ReducedCurvilinear, ARampStaysWhereItIs) {
    const glm::dvec3 slope(0.5, 3.0, -0.25);
    const auto ramp = [&](const glm::dvec3& c) { return dot(slope, c); };
    const Volume volume = make_volume(sector(), {37, 29, 17}, ramp);
    for (const int factor : {2, 3, 5, 16}) {
        for_each(reduced(volume, factor), [&](const glm::dvec3& coordinates, double value) {
            ASSERT_NEAR(value, ramp(coordinates), 2e-6) << factor;
        });
    }
}

TEST(ReducedCurvilinear, NothingTurnsOnARing) {
    const Volume volume =
        make_volume(ring(), {3, 37, 3}, [](const glm::dvec3& c) { return std::cos(c.y - 1.0); });
    for (const int factor : {2, 3, 5}) {
        double in_phase = 0.0;
        double out_of_phase = 0.0;
        double count = 0.0;
        for_each(reduced(volume, factor), [&](const glm::dvec3& coordinates, double value) {
            in_phase += 2.0 * value * std::cos(coordinates.y - 1.0);
            out_of_phase += 2.0 * value * std::sin(coordinates.y - 1.0);
            count += 1.0;
        });
        // The mean over an interval of half-width h has sin(h)/h of a wave's height.
        const double h = 0.5 * 2.0 * pi * factor / 37.0;
        EXPECT_NEAR(in_phase / count, std::sin(h) / h, 0.01) << factor;
        EXPECT_NEAR(out_of_phase / count, 0.0, 5e-3) << factor;
    }
}

TEST(ReducedCurvilinear, TheSumAroundARingStays) {
    std::uint32_t state = 1;
    const Volume volume = make_volume(ring(), {1, 45, 1}, [&](const glm::dvec3&) {
        state = state * 1664525U + 1013904223U;
        return static_cast<double>(state >> 8U) / (1U << 24U);
    });
    const auto mean = [](const Volume& of) {
        double sum = 0.0;
        for_each(of, [&](const glm::dvec3&, double value) { sum += value; });
        return sum / of.grid.dims.y;
    };
    for (const int factor : {2, 3, 4, 9}) {
        EXPECT_NEAR(mean(reduced(volume, factor)), mean(volume), 1e-6) << factor;
    }
}

TEST(ReducedCurvilinear, VoxelsThatAreNotFiniteAreLeftOut) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Volume volume =
        make_volume(ring(), {9, 8, 5}, [&](const glm::dvec3& c) { return c.x < 10.0 ? nan : 0.5; });
    std::size_t empty = 0;
    for_each(reduced(volume, 2), [&](const glm::dvec3& c, double value) {
        empty += std::isnan(value) ? 1U : 0U;
        ASSERT_TRUE(c.x < 10.0 || value == 0.5);
    });
    EXPECT_GT(empty, 0U);
}

TEST(ReducedCurvilinear, IntegersAreRoundedAndLabelsTaken) {
    Volume volume{.grid = {.dims = {5, 1, 1}, .shape = sector()}, .type = ScalarType::u8, .voxels = {}};
    for (const int value : {10, 20, 32, 40, 50}) {
        volume.voxels.push_back(static_cast<std::byte>(value));
    }
    const auto bytes = [](std::initializer_list<int> values) {
        std::vector<std::byte> result;
        for (const int value : values) {
            result.push_back(static_cast<std::byte>(value));
        }
        return result;
    };
    // In the middle (20 + 2 * 32 + 40) / 4, since linear interpolation gives the neighbours half a weight
    // each.
    EXPECT_EQ(reduced(volume, 2).voxels, bytes({10, 31, 50}));
    EXPECT_EQ(reduced(volume, 4).voxels, bytes({10, 50}));
    EXPECT_EQ(reduced(volume, 2, true).voxels, bytes({10, 32, 50}));
    EXPECT_EQ(reduced(volume, 3, true).voxels, bytes({10, 50}));
}

}  // namespace
}  // namespace viscera::test

#include "engine/core/volume_shape.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/core/volume.h"

namespace viscera {
namespace {

using std::numbers::pi;

VolumeShape cylinder() {
    return {.kind = VolumeKind::cylindrical,
            .r_min_mm = 2.0,
            .r_max_mm = 10.0,
            .first_angle_rad = 0.3,
            .angle_rad = 4.0,
            .height_mm = 30.0};
}

VolumeShape sphere() {
    return {.kind = VolumeKind::spherical,
            .r_min_mm = 0.0,
            .r_max_mm = 10.0,
            .first_angle_rad = -1.0,
            .angle_rad = 2.0 * pi,
            .wrap = true,
            .latitude_rad = pi};
}

TEST(VolumeShape, EndsAreSamplesAndARingHasOneIntervalMore) {
    const ShapeAxes c = axes_of(cylinder(), {5, 9, 4});
    EXPECT_EQ(c.first, glm::dvec3(2.0, 0.3, 0.0));
    EXPECT_EQ(c.step, glm::dvec3(2.0, 0.5, 10.0));
    const ShapeAxes s = axes_of(sphere(), {8, 5, 11});
    EXPECT_EQ(s.first, glm::dvec3(-1.0, -0.5 * pi, 0.0));
    EXPECT_EQ(s.step, glm::dvec3(0.25 * pi, 0.25 * pi, 1.0));
    EXPECT_EQ(axes_of(cylinder(), glm::ivec3(1)).step, glm::dvec3(8.0, 4.0, 30.0));
}

TEST(VolumeShape, CoordinatesGoThereAndBack) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const VolumeShape& shape : {cylinder(), sphere()}) {
        const ShapeAxes axes = axes_of(shape, glm::ivec3(7));
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 c =
                axes.first +
                axes.extent * (0.01 + 0.98 * glm::dvec3(unit(random), unit(random), unit(random)));
            EXPECT_LT(glm::length(from_frame(shape, to_frame(shape, c)) - c), 1e-12);
        }
    }
    EXPECT_EQ(from_frame(sphere(), glm::dvec3(0.0)), glm::dvec3(0.0));
    EXPECT_EQ(from_frame(sphere(), glm::dvec3(0.0, 0.0, -3.0)), glm::dvec3(0.0, -0.5 * pi, 3.0));
    // The gap is cut in its middle.
    const double gap = 2.0 * pi - 4.0;
    EXPECT_NEAR(from_frame(cylinder(), to_frame(cylinder(), {5.0, 0.3 - 0.4 * gap, 1.0})).y, 0.3 - 0.4 * gap,
                1e-12);
    EXPECT_NEAR(from_frame(cylinder(), to_frame(cylinder(), {5.0, 0.3 - 0.6 * gap, 1.0})).y, 4.3 + 0.4 * gap,
                1e-12);
}

TEST(VolumeShape, BoxesHoldTheShapeClosely) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto draw = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
    for (int k = 0; k < 60; ++k) {
        VolumeShape shape = k % 2 == 0 ? cylinder() : sphere();
        const ShapeAxes axes = axes_of(shape, glm::ivec3(2));
        const glm::dvec3 a = axes.first + axes.extent * draw();
        const glm::dvec3 b = axes.first + axes.extent * draw();
        const glm::dvec3 low = glm::min(a, b);
        const glm::dvec3 high = glm::max(a, b);
        const FrameBox box = box_around(shape, low, high);
        glm::dvec3 least(1e300);
        glm::dvec3 most(-1e300);
        constexpr int n = 40;
        for (int i = 0; i < n * n * n; ++i) {
            const glm::dvec3 t = glm::dvec3(i % n, i / n % n, i / n / n) / (n - 1.0);
            const glm::dvec3 p = to_frame(shape, glm::mix(low, high, t));
            least = glm::min(least, p);
            most = glm::max(most, p);
        }
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LE(box.min[axis], least[axis] + 1e-12);
            EXPECT_GE(box.max[axis], most[axis] - 1e-12);
            EXPECT_NEAR(box.min[axis], least[axis], 0.05);
            EXPECT_NEAR(box.max[axis], most[axis], 0.05);
        }
    }
    const FrameBox whole = box_around(sphere());
    EXPECT_LT(glm::length(whole.min + 10.0), 1e-12);
    EXPECT_LT(glm::length(whole.max - 10.0), 1e-12);
}

TEST(VolumeShape, GridsPlaceSamplesInTheWorld) {
    const VolumeGrid grid{.dims = {5, 9, 4},
                          .origin_mm = {100.0, -20.0, 7.0},
                          .direction = glm::dmat3({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}),
                          .shape = cylinder()};
    // Frame x is the world's y: angle 0.3 + 4 * 0.5, radius 4, height 10.
    const glm::dvec3 wanted = grid.origin_mm + glm::dvec3(-4.0 * std::sin(2.3), 4.0 * std::cos(2.3), 10.0);
    EXPECT_LT(glm::length(grid.world_of_index({1.0, 4.0, 1.0}) - wanted), 1e-12);
    EXPECT_LT(glm::length(grid.index_of_world(wanted) - glm::dvec3(1.0, 4.0, 1.0)), 1e-12);
    const glm::dmat4 box = grid.box_to_world();
    for (const glm::dvec3 index : {glm::dvec3(0, 0, 0), glm::dvec3(4, 8, 3), glm::dvec3(4, 2, 1)}) {
        const glm::dvec3 p = glm::inverse(box) * glm::dvec4(grid.world_of_index(index), 1.0);
        EXPECT_TRUE(glm::all(glm::greaterThan(p, glm::dvec3(-1e-9))));
        EXPECT_TRUE(glm::all(glm::lessThan(p, glm::dvec3(1.0 + 1e-9))));
    }
}

TEST(VolumeShape, WhatCannotBeIsNamed) {
    const auto expect = [](std::string_view field, const VolumeShape& shape) {
        try {
            shape.validate("test");
            ADD_FAILURE() << field << " is taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file);
            EXPECT_NE(error.message().find(field), std::string_view::npos) << error.what();
        }
    };
    EXPECT_NO_THROW(cylinder().validate("test"));
    EXPECT_NO_THROW(sphere().validate("test"));
    EXPECT_NO_THROW(VolumeShape{}.validate("test"));
    VolumeShape s = cylinder();
    s.r_min_mm = -1.0;
    expect("r_min", s);
    s = cylinder();
    s.r_max_mm = 1.0;
    expect("r_max", s);
    s = cylinder();
    s.angle_rad = 6.3;
    expect("angle", s);
    s = cylinder();
    s.height_mm = std::numeric_limits<double>::quiet_NaN();
    expect("height", s);
    s = cylinder();
    s.wrap = true;
    expect("wrap", s);
    s = sphere();
    s.latitude_rad = 3.2;
    expect("latitude", s);
    // Flat ones can be, but show nothing.
    s = cylinder();
    s.r_max_mm = s.r_min_mm;
    EXPECT_NO_THROW(s.validate("test"));
    EXPECT_TRUE(s.flat());
    EXPECT_FALSE(cylinder().flat());
    EXPECT_FALSE(VolumeShape{}.flat());
}

}  // namespace
}  // namespace viscera

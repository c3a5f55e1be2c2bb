#include "effects/contrast/bolus.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "effects/contrast/density.h"
#include "engine/core/error.h"
#include "tests/core/not_finite.h"

namespace viscera::contrast {
namespace {

// The GLSL of bolus.h, operation by operation.
float density_as_shader(const Bolus::Uniforms& u, float x) {
    const float t = std::clamp(x * u.inv_rise, 0.0F, 1.0F);
    const float tail = std::max(
        0.0F, std::exp(-std::max(0.0F, x - u.duration) * u.inv_washout) * u.tail_scale - u.tail_offset);
    return u.amplitude * (t * t * (3.0F - 2.0F * t)) * tail;
}

TEST(Bolus, RisesHoldsAndWashesOut) {
    Log log;
    const Bolus bolus({.duration_s = 2.0, .rise_s = 0.5, .amplitude = 0.8, .washout_s = 0.7}, log);
    EXPECT_EQ(bolus.density(-0.1), 0.0);
    EXPECT_EQ(bolus.density(0.0), 0.0);
    EXPECT_NEAR(bolus.density(0.25), 0.4, 1e-15);
    EXPECT_NEAR(bolus.density(1.9), 0.8, 1e-15);
    EXPECT_NEAR(bolus.density(2.7), 0.8 * (std::exp(-1.0) - 1.0 / 4096) / (1.0 - 1.0 / 4096), 1e-15);
    EXPECT_EQ(bolus.density(2.0 + 8.32 * 0.7), 0.0);
    EXPECT_EQ(bolus.density(nan), 0.0);
    EXPECT_EQ(bolus.density(std::numeric_limits<double>::infinity()), 0.0);
    EXPECT_EQ(bolus.density(10.0 - static_cast<double>(unreached_s)), 0.0);
}

TEST(Bolus, RiseHasNoKink) {
    Log log;
    const Bolus bolus({.duration_s = 2.0, .rise_s = 0.5}, log);
    const double h = 1.0e-6;
    for (const double x : {0.0, 0.5}) {
        const double left = (bolus.density(x) - bolus.density(x - h)) / h;
        const double right = (bolus.density(x + h) - bolus.density(x)) / h;
        EXPECT_NEAR(left, right, 1.0e-4) << x;
    }
}

TEST(Bolus, FloatFormulaFollowsTheDouble) {
    Log log;
    const Bolus bolus({.duration_s = 1.3, .rise_s = 0.4, .amplitude = 0.9, .washout_s = 0.55}, log);
    double worst = 0.0;
    for (int i = -1000; i <= 8000; ++i) {
        const float x = static_cast<float>(i) / 1000.0F;
        worst = std::max(worst, std::abs(static_cast<double>(density_as_shader(bolus.uniforms(), x)) -
                                         bolus.density(static_cast<double>(x))));
    }
    EXPECT_LE(worst, 5.0e-7);
}

void expect_bounds_hold(const Bolus& bolus) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> time(-2.0, 9.0);
    for (int trial = 0; trial < 300; ++trial) {
        const auto [first, last] = std::minmax({time(random), time(random)});
        const DensityRange range = bolus.range(first, last);
        double least = 2.0;
        double most = -1.0;
        for (int i = 0; i <= 500; ++i) {
            const double d = bolus.density(first + (last - first) * i / 500.0);
            least = std::min(least, d);
            most = std::max(most, d);
        }
        ASSERT_LE(range.lower, least + 1e-15) << first << " .. " << last;
        ASSERT_GE(range.upper, most - 1e-15) << first << " .. " << last;
        ASSERT_LE(range.upper, 1.0);
        if (bolus.zero_on(first, last)) {
            ASSERT_EQ(most, 0.0);
        }
    }
}

TEST(Bolus, BoundsHold) {
    Log log;
    expect_bounds_hold(Bolus({.duration_s = 2.0, .rise_s = 0.5}, log));
    expect_bounds_hold(Bolus({.duration_s = 0.2, .rise_s = 0.9}, log));
    expect_bounds_hold(Bolus({.table = {{0.0, 0.0}, {0.5, 1.0}, {0.7, 0.2}, {2.0, 0.6}, {4.0, 0.0}}}, log));
}

TEST(Bolus, KnowsWhenItIsZero) {
    Log log;
    const Bolus bolus({.duration_s = 2.0, .rise_s = 0.5, .washout_s = 0.5}, log);
    EXPECT_TRUE(bolus.zero_on(-5.0, 0.0));
    EXPECT_FALSE(bolus.zero_on(-5.0, 0.01));
    EXPECT_FALSE(bolus.zero_on(2.0, 5.0));
    EXPECT_TRUE(bolus.zero_on(2.0 + 8.32 * 0.5, 100.0));
    EXPECT_TRUE(bolus.zero_on(nan, 1.0));
    const Bolus table({.table = {{0.0, 0.0}, {1.0, 1.0}, {2.0, 0.0}}}, log);
    EXPECT_TRUE(table.zero_on(-3.0, 0.0));
    EXPECT_TRUE(table.zero_on(2.0, 9.0));
    EXPECT_FALSE(table.zero_on(-3.0, 9.0));
}

TEST(Bolus, TableIsPiecewiseLinearAndStopsWhereItIsTold) {
    Log log;
    // Points out of order; the knot at 1.0 lies on a sample (1023 steps over 3 s: sample 341).
    const Bolus bolus({.table = {{3.0, 0.25}, {0.0, 0.5}, {1.0, 1.0}}}, log);
    EXPECT_EQ(bolus.density(-1e-9), 0.0);
    EXPECT_NEAR(bolus.density(0.0), 0.5, 1e-7);
    EXPECT_NEAR(bolus.density(0.37), 0.685, 1e-7);
    EXPECT_NEAR(bolus.density(1.0), 1.0, 1e-7);
    EXPECT_NEAR(bolus.density(2.0), 0.625, 1e-7);
    EXPECT_EQ(bolus.density(99.0), 0.25);
    EXPECT_TRUE(log.faults().empty());
}

TEST(Bolus, BadTablesStayFiniteAndSaySo) {
    Log log;
    const Bolus bolus({.table = {{0.0, nan}, {nan, 1.0}, {0.0, -2.0}, {1.0, 7.0}}}, log);
    EXPECT_EQ(log.faults().at("contrast.bolus_table"), 4U);
    EXPECT_NEAR(bolus.density(0.5), 0.5, 1e-6);
    const Bolus nothing({.table = {{nan, nan}}}, log);
    EXPECT_TRUE(nothing.zero_on(-1e9, 1e9));
    const Bolus single({.table = {{1.0, 0.5}}}, log);
    EXPECT_EQ(single.density(0.9), 0.0);
    EXPECT_EQ(single.density(1.0), 0.5);
    const Bolus step({.table = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {2.0, 1.0}}}, log);
    EXPECT_EQ(step.density(0.9), 0.0);
    EXPECT_NEAR(step.density(1.1), 1.0, 1e-7);
}

TEST(Bolus, RefusesSettingsThatMeanNothing) {
    Log log;
    EXPECT_THROW(Bolus({.rise_s = 0.0}, log), Error);
    EXPECT_THROW(Bolus({.washout_s = -1.0}, log), Error);
    EXPECT_THROW(Bolus({.start_s = nan}, log), Error);
}

TEST(Density, ClampsAndCounts) {
    std::vector<float> density{
        0.5F, -0.1F, 1.5F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        1.0F};
    Log log;
    const DensityFaults faults = sanitise_density(density, log);
    EXPECT_EQ(density, (std::vector<float>{0.5F, 0.0F, 1.0F, 0.0F, 1.0F, 1.0F}));
    EXPECT_EQ(faults.not_finite, 1U);
    EXPECT_EQ(faults.outside, 3U);
    EXPECT_EQ(log.faults().at("contrast.density_nan"), 1U);
    EXPECT_EQ(log.faults().at("contrast.density_range"), 3U);
    Log clean;
    sanitise_density(density, clean);
    EXPECT_TRUE(clean.faults().empty());
}

}  // namespace
}  // namespace viscera::contrast

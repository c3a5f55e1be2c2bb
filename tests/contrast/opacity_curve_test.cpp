#include "effects/contrast/opacity_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/reference/contrast.h"

namespace viscera::contrast {
namespace {

TEST(OpacityCurve, ClosedFormIsTheLoopForAnyN) {
    for (const int n : {1, 2, 3, 7, 25, 64, 200}) {
        double worst = 0.0;
        for (int i = 0; i <= 4000; ++i) {
            const double a = i / 4000.0;
            worst = std::max(worst, std::abs(opacity(a, n) - reference::opacity_loop(a, n)));
        }
        EXPECT_LT(worst, 1.0e-12) << "N = " << n;
    }
}

TEST(OpacityCurve, SaturatesWhereTheLoopDoes) {
    for (const int n : {1, 2, 25, 100}) {
        const double a = opacity_saturation(n);
        EXPECT_NEAR(reference::opacity_loop(a, n), 1.0, 1.0e-12) << "N = " << n;
        EXPECT_LT(reference::opacity_loop(a - 1.0e-6, n), 1.0) << "N = " << n;
    }
    EXPECT_NEAR(opacity_saturation(25), 0.17514, 1.0e-5);
    EXPECT_EQ(opacity_saturation(1), 0.5);
}

TEST(OpacityCurve, FloatFormIsWithin3e7OfTheLoop) {
    ASSERT_EQ(opacity_lines(opacity_terms).size(), opacity_line_count);
    double worst = 0.0;
    for (int i = 0; i <= 1000000; ++i) {
        const float a = static_cast<float>(i) / 1.0e6F;
        const double error =
            std::abs(static_cast<double>(opacity_float(a)) - reference::opacity_loop(static_cast<double>(a)));
        worst = std::max(worst, error);
    }
    RecordProperty("worst", std::to_string(worst));
    EXPECT_LE(worst, 3.0e-7);
}

// The constants that opacity_curve.h prints for GLSL.
TEST(OpacityCurve, PrintedConstantsAreTheTable) {
    const float printed[][2] = {{2.0F, 0.0F},
                                {4.0833335F, 0.083333336F},
                                {6.2572465F, 0.25724638F},
                                {8.529974F, 0.52997363F},
                                {10.910926F, 0.91092604F}};
    for (std::size_t k = 0; k < opacity_line_count; ++k) {
        EXPECT_EQ(opacity_lines_float[k].slope, printed[k][0]) << k;
        EXPECT_EQ(opacity_lines_float[k].offset, printed[k][1]) << k;
    }
}

TEST(OpacityCurve, NeverFalls) {
    float before = 0.0F;
    for (int i = 0; i <= 1000000; ++i) {
        const float s = opacity_float(static_cast<float>(i) / 1.0e6F);
        ASSERT_GE(s, before) << i;
        before = s;
    }
    EXPECT_EQ(opacity_float(0.0F), 0.0F);
    EXPECT_EQ(opacity_float(1.0F), 1.0F);
}

TEST(OpacityCurve, TakesAnyNumber) {
    EXPECT_EQ(opacity(std::numeric_limits<double>::quiet_NaN(), 25), 0.0);
    EXPECT_EQ(opacity(-1.0, 25), 0.0);
    EXPECT_EQ(opacity(std::numeric_limits<double>::infinity(), 25), 1.0);
    EXPECT_EQ(opacity(0.7, -3), 1.0);
}

}  // namespace
}  // namespace viscera::contrast

#include "engine/core/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/core/params_json.h"
#include "tests/core/not_finite.h"

namespace viscera {
namespace {

TransferFunction function_of(std::vector<TransferPoint> points) {
    TransferFunction function;
    function.points = std::move(points);
    return function;
}

TransferPoint grey(double value, double opacity, double shade = 0.5) {
    return {value, glm::dvec3(shade), opacity};
}

TEST(TransferFunction, IsLinearBetweenKnotsAndConstantBeyond) {
    const TransferFunction f = function_of({{-100.0, {1.0, 0.0, 0.2}, 0.1}, {300.0, {0.0, 1.0, 0.6}, 0.9}});
    EXPECT_EQ(evaluate(f, -100.0), glm::dvec4(1.0, 0.0, 0.2, 0.1));
    EXPECT_EQ(evaluate(f, -101.0), glm::dvec4(1.0, 0.0, 0.2, 0.1));
    EXPECT_EQ(evaluate(f, -infinity), glm::dvec4(1.0, 0.0, 0.2, 0.1));
    EXPECT_EQ(evaluate(f, 300.0), glm::dvec4(0.0, 1.0, 0.6, 0.9));
    EXPECT_EQ(evaluate(f, infinity), glm::dvec4(0.0, 1.0, 0.6, 0.9));
    const glm::dvec4 quarter = evaluate(f, 0.0);
    EXPECT_NEAR(quarter.x, 0.75, 1e-15);
    EXPECT_NEAR(quarter.y, 0.25, 1e-15);
    EXPECT_NEAR(quarter.z, 0.3, 1e-15);
    EXPECT_NEAR(quarter.w, 0.3, 1e-15);
}

TEST(TransferFunction, StepTakesTheRightSide) {
    const TransferFunction f = function_of({grey(0.0, 0.0), grey(1.0, 0.0), grey(1.0, 0.8), grey(2.0, 0.8)});
    EXPECT_EQ(evaluate(f, std::nextafter(1.0, 0.0)).w, 0.0);
    EXPECT_EQ(evaluate(f, 1.0).w, 0.8);
    EXPECT_EQ(evaluate(function_of({grey(1.0, 0.3), grey(1.0, 0.7)}), 1.0).w, 0.7);
    EXPECT_EQ(evaluate(function_of({grey(1.0, 0.3), grey(1.0, 0.7)}), 0.9).w, 0.3);
}

TEST(TransferFunction, NothingIsTransparent) {
    EXPECT_EQ(evaluate({}, 1.0), glm::dvec4(0.0));
    EXPECT_EQ(evaluate(function_of({grey(0.0, 1.0)}), nan), glm::dvec4(0.0));
}

TEST(TransferFunction, KnotsAtTheEndsOfDouble) {
    constexpr double most = std::numeric_limits<double>::max();
    const TransferFunction f = function_of({grey(-most, 0.0), grey(most, 1.0)});
    EXPECT_NEAR(evaluate(f, 0.0).w, 0.5, 1e-15);
    EXPECT_NEAR(evaluate(f, most / 2).w, 0.75, 1e-15);
    constexpr double least = std::numeric_limits<double>::denorm_min();
    EXPECT_EQ(evaluate(function_of({grey(0.0, 0.25), grey(least, 1.0)}), 0.0).w, 0.25);
}

TEST(TransferFunction, NormalisedSortsCutsAndCounts) {
    TransferFunction f = function_of({grey(5.0, 0.5),
                                      grey(1.0, 2.0),
                                      grey(nan, 0.5),
                                      grey(1.0, 0.25),
                                      grey(2.0, nan),
                                      {3.0, {-1.0, 0.5, 7.0}, 0.5}});
    f.gradient = {{3.0, 0.5}, {-1.0, 1.5}, {nan, 1.0}};
    f.reference_length_mm = -2.0;
    f.lighting.ambient = nan;
    f.lighting.shininess = -4.0;
    std::size_t faults = 0;
    const TransferFunction g = normalised(f, faults);
    // Two points dropped, an opacity and two colours cut, a gradient point dropped, two numbers of one cut,
    // the length and two coefficients.
    EXPECT_EQ(faults, 2U + 3U + 1U + 2U + 1U + 2U);
    const std::vector<TransferPoint> points{
        grey(1.0, 1.0), grey(1.0, 0.25), {3.0, {0.0, 0.5, 1.0}, 0.5}, grey(5.0, 0.5)};
    EXPECT_EQ(g.points, points);
    EXPECT_EQ(g.gradient, (std::vector<GradientPoint>{{0.0, 1.0}, {3.0, 0.5}}));
    EXPECT_EQ(g.reference_length_mm, 1.0);
    EXPECT_EQ(g.lighting.ambient, Lighting{}.ambient);
    EXPECT_EQ(g.lighting.shininess, 0.0);

    faults = 0;
    EXPECT_EQ(normalised(g, faults), g);
    EXPECT_EQ(faults, 0U);
}

TEST(TransferFunction, NormalisedEmptyIsOneTransparentPoint) {
    std::size_t faults = 0;
    const TransferFunction f = normalised({}, faults);
    ASSERT_EQ(f.points.size(), 1U);
    EXPECT_EQ(f.points[0].opacity, 0.0);
    EXPECT_EQ(faults, 0U);
    EXPECT_TRUE(visible_ranges(f).empty());
}

TEST(TransferFunction, ExtinctionGivesTheOpacityBack) {
    for (const double opacity : {0.0, 1e-9, 0.1, 0.5, 0.99}) {
        for (const double length : {0.1, 1.0, 7.0}) {
            EXPECT_NEAR(-std::expm1(-extinction(opacity, length) * length), opacity, 1e-15);
        }
    }
    EXPECT_TRUE(std::isfinite(extinction(1.0, 1.0)));
    EXPECT_NEAR(extinction(1.0, 2.0), 24.0 * std::log(2.0) / 2.0, 1e-12);
    EXPECT_EQ(extinction(7.0, 1.0), extinction(1.0, 1.0));
    EXPECT_EQ(extinction(-1.0, 1.0), 0.0);
    EXPECT_EQ(extinction(nan, 1.0), 0.0);
}

TEST(TransferFunction, WindowRunsFromBlackToWhite) {
    const TransferFunction f = make_window({.width = 400.0, .level = 40.0});
    EXPECT_EQ(evaluate(f, -160.0), glm::dvec4(0.0));
    EXPECT_EQ(evaluate(f, -161.0), glm::dvec4(0.0));
    EXPECT_EQ(evaluate(f, 240.0), glm::dvec4(1.0));
    EXPECT_NEAR(evaluate(f, 40.0).x, 0.5, 1e-15);
    EXPECT_NEAR(evaluate(f, 140.0).w, 0.75, 1e-15);
}

TEST(TransferFunction, WindowPresetsAreDistinctAndSound) {
    std::set<std::string_view> names;
    for (const WindowPreset& preset : window_presets()) {
        EXPECT_TRUE(names.insert(preset.name).second) << preset.name;
        EXPECT_GT(preset.window.width, 0.0) << preset.name;
        EXPECT_FALSE(preset.doc.empty()) << preset.name;
    }
    EXPECT_EQ(names.size(), 12U);
    const auto lung = std::ranges::find(window_presets(), "ct-lung", &WindowPreset::name);
    ASSERT_NE(lung, window_presets().end());
    EXPECT_EQ(lung->window.width, 1500.0);
    EXPECT_EQ(lung->window.level, -600.0);
}

void expect_ranges(const TransferFunction& f, const std::vector<std::pair<double, double>>& expected) {
    const std::vector<ValueRange> ranges = visible_ranges(f);
    ASSERT_EQ(ranges.size(), expected.size());
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        EXPECT_EQ(ranges[i].low, expected[i].first) << i;
        EXPECT_EQ(ranges[i].high, expected[i].second) << i;
    }
}

TEST(TransferFunction, VisibleRangesAreExact) {
    expect_ranges({}, {});
    expect_ranges(function_of({grey(3.0, 0.5)}), {{-infinity, infinity}});
    expect_ranges(function_of({grey(0.0, 0.0), grey(1.0, 0.0), grey(2.0, 0.5), grey(3.0, 0.0)}),
                  {{1.0, 3.0}});
    expect_ranges(function_of({grey(0.0, 0.5), grey(1.0, 0.0), grey(2.0, 0.0), grey(3.0, 0.5)}),
                  {{-infinity, 1.0}, {2.0, infinity}});
    // Ranges that touch are one; steps begin and end where they stand.
    expect_ranges(function_of({grey(0.0, 0.0), grey(0.0, 1.0), grey(1.0, 1.0), grey(1.0, 0.0), grey(2.0, 0.0),
                               grey(3.0, 1.0), grey(4.0, 0.0), grey(5.0, 1.0), grey(6.0, 0.0)}),
                  {{0.0, 1.0}, {2.0, 6.0}});
    // A spike without width shows nothing.
    expect_ranges(function_of({grey(1.0, 0.0), grey(1.0, 1.0), grey(1.0, 0.0)}), {});
}

TEST(TransferFunction, VisibleRangesHoldWhatEvaluateShows) {
    const TransferFunction f =
        function_of({grey(-5.0, 0.0), grey(-2.0, 0.0), grey(-1.0, 0.3), grey(-1.0, 0.0), grey(0.5, 0.0),
                     grey(0.5, 0.2), grey(1.0, 0.0), grey(4.0, 0.0), grey(4.0, 0.9)});
    const std::vector<ValueRange> ranges = visible_ranges(f);
    for (int i = -6000; i <= 6000; ++i) {
        const double value = i / 1000.0;
        const bool inside = std::ranges::any_of(
            ranges, [&](const ValueRange& r) { return value >= r.low && value <= r.high; });
        if (evaluate(f, value).w > 0.0) {
            EXPECT_TRUE(inside) << value;
        } else if (inside) {
            // Only the ends of a range may show nothing.
            EXPECT_TRUE(std::ranges::any_of(ranges, [&](const ValueRange& r) {
                return value == r.low || value == r.high;
            })) << value;
        }
    }
}

TEST(TransferFunction, ParametersAreWrittenAndReadBack) {
    TransferPoint point{-120.0, {0.1, 0.2, 0.3}, 0.4};
    GradientPoint gradient{12.0, 0.5};
    Lighting lighting{0.1, 0.2, 0.3, 40.0};
    WindowLevel window{250.0, 50.0};
    const auto check = [](auto value) {
        const nlohmann::json written = write_params([&](ParamVisitor& v) { value.visit(v); });
        decltype(value) back;
        std::vector<JsonFault> faults;
        read_params(
            written, "", "", [&](ParamVisitor& v) { back.visit(v); }, faults);
        EXPECT_TRUE(faults.empty());
        EXPECT_EQ(write_params([&](ParamVisitor& v) { back.visit(v); }), written);
    };
    check(point);
    check(gradient);
    check(lighting);
    check(window);
    EXPECT_EQ(choice_names(Technique::xray)[static_cast<std::size_t>(Technique::xray)], "xray");
}

}  // namespace
}  // namespace viscera

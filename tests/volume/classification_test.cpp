#include "effects/volume/classification.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace viscera::volume {
namespace {

constexpr TexelRange unit{0.0, 1.0};

TransferPoint point(double value, double opacity, glm::dvec3 colour = {0.25, 0.5, 1.0}) {
    return {value, colour, opacity};
}

TransferFunction function_of(std::vector<TransferPoint> points) {
    std::size_t faults = 0;
    TransferFunction function;
    function.points = std::move(points);
    function.reference_length_mm = 2.0;
    return normalised(std::move(function), faults);
}

/// Every third knot is a step.
TransferFunction random_function(std::mt19937& random, double low, double high) {
    std::uniform_real_distribution<double> place(low, high);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::vector<TransferPoint> points;
    for (int i = 0; i < 12; ++i) {
        const double at = place(random);
        for (int k = 0; k < (i % 3 == 0 ? 2 : 1); ++k) {
            const double opacity = i % 4 == 0 ? 0.0 : share(random);
            points.push_back({at, {share(random), share(random), share(random)}, opacity});
        }
    }
    return function_of(points);
}

bool near_knot(const TransferFunction& f, const TexelMap& map, double texel, double distance) {
    return std::ranges::any_of(
        f.points, [&](const TransferPoint& p) { return std::abs(map.texel_of(p.value) - texel) < distance; });
}

void expect_near(const glm::dvec4& found, const glm::dvec4& expected, double tolerance, double where) {
    for (int c = 0; c < 4; ++c) {
        EXPECT_NEAR(found[c], expected[c], tolerance) << "component " << c << " at " << where;
    }
}

TEST(ExtinctionKnots, AreTheFunctionAwayFromSteps) {
    std::mt19937 random(7);
    for (const TexelMap map : {TexelMap{1.0, 0.0}, TexelMap{4095.0, -1024.0}, TexelMap{-65535.0, 300.0}}) {
        for (int round = 0; round < 20; ++round) {
            const double a = map.value_of(-0.2);
            const double b = map.value_of(1.2);
            const TransferFunction f = random_function(random, std::min(a, b), std::max(a, b));
            const ExtinctionKnots knots = extinction_knots(f, map, unit);
            for (int i = 0; i <= 2000; ++i) {
                const double texel = i / 2000.0;
                if (!near_knot(f, map, texel, 1e-6)) {
                    // A step's ends, and with them the slopes beside it, are up to 3 roundings beside the
                    // knot.
                    const glm::dvec4 moved = glm::abs(evaluate(f, map.value_of(texel + 1e-7)) -
                                                      evaluate(f, map.value_of(texel - 1e-7)));
                    const double slope = std::max({moved.x, moved.y, moved.z, moved.w});
                    expect_near(knots.evaluate(texel), evaluate(f, map.value_of(texel)), 1e-9 + slope, texel);
                }
            }
        }
    }
}

TEST(ExtinctionKnots, AreApartAscendingAndInside) {
    std::mt19937 random(11);
    for (const TexelRange range :
         {unit, TexelRange{-1024.0, 3071.0}, TexelRange{0.25, 0.3}, TexelRange{-1.0, 0.0}}) {
        for (int round = 0; round < 50; ++round) {
            TransferFunction f = random_function(random, range.low, range.high);
            // A crowd of knots a rounding apart, at an end too.
            for (const double crowd : {f.points[3].value, range.high, range.low}) {
                for (int i = 0; i < 9; ++i) {
                    f.points.push_back(point(crowd + (i - 4) * range.resolution() / 3.0, i % 2));
                }
            }
            f = function_of(f.points);
            for (const double scale : {1.0, -1.0}) {
                const ExtinctionKnots knots =
                    extinction_knots(f, {scale, scale > 0.0 ? 0.0 : range.low + range.high}, range);
                ASSERT_FALSE(knots.knots.empty());
                EXPECT_GE(knots.knots.front().texel, static_cast<float>(range.low));
                EXPECT_LE(knots.knots.back().texel, static_cast<float>(range.high));
                for (std::size_t i = 1; i < knots.knots.size(); ++i) {
                    EXPECT_GE(static_cast<double>(knots.knots[i].texel) -
                                  static_cast<double>(knots.knots[i - 1].texel),
                              0.49 * range.resolution());
                    EXPECT_LT(knots.knots[i - 1].texel, knots.knots[i].texel);
                }
            }
        }
    }
}

// What a u8 texture gives, even where the device misses it by a rounding, is on the right side of a step.
TEST(ExtinctionKnots, StepsAtWholeNumbersHoldForTexelsOfThem) {
    for (const double scale : {255.0, -255.0}) {
        const TexelMap map{scale, scale > 0.0 ? 0.0 : 255.0};
        for (int step = 0; step <= 255; ++step) {
            const TransferFunction f = function_of({point(step, 0.125), point(step, 0.75)});
            const ExtinctionKnots knots = extinction_knots(f, map, unit);
            for (int value = 0; value <= 255; ++value) {
                const auto texel = static_cast<float>(map.texel_of(value));
                for (const float missed : {texel, std::nextafter(texel, 0.0F), std::nextafter(texel, 1.0F)}) {
                    ASSERT_EQ(knots.evaluate(static_cast<double>(missed)).w, evaluate(f, value).w)
                        << "step " << step << " value " << value << " scale " << scale;
                }
            }
        }
    }
}

TEST(ExtinctionKnots, LeaveOutWhatIsStraight) {
    std::vector<TransferPoint> points;
    for (int i = 0; i <= 100; ++i) {
        points.push_back(point(i / 100.0, i <= 50 ? 0.0 : (i - 50) / 50.0));
    }
    const ExtinctionKnots knots = extinction_knots(function_of(points), {}, unit);
    ASSERT_EQ(knots.knots.size(), 2U);
    EXPECT_EQ(knots.knots[0].texel, 0.5F);
    EXPECT_EQ(knots.knots[1].texel, 1.0F);
    EXPECT_EQ(extinction_knots(function_of({point(0.3, 0.5), point(0.6, 0.5)}), {}, unit).knots.size(), 1U);
}

TEST(ExtinctionKnots, DegenerateRangesAndFunctions) {
    const TransferFunction f = function_of({point(0.0, 0.0), point(1.0, 1.0)});
    const ExtinctionKnots one = extinction_knots(f, {}, {0.5, 0.5});
    ASSERT_EQ(one.knots.size(), 1U);
    EXPECT_EQ(one.evaluate(-7.0).w, 0.5);
    EXPECT_EQ(one.evaluate(std::numeric_limits<double>::quiet_NaN()).w, 0.0);
    EXPECT_EQ(extinction_knots(function_of({}), {}, unit).most_extinction(), 0.0);
    const ExtinctionKnots opaque = extinction_knots(f, {}, unit);
    EXPECT_EQ(opaque.most_extinction(), extinction(1.0, 2.0));
    EXPECT_NEAR(opaque.classify(0.5).w, std::log(2.0) / 2.0, 1e-15);
}

TEST(ClassificationTable, EntriesAreTheFunctionAndItsEnds) {
    const TransferFunction f =
        function_of({point(40.0, 0.0, {1.0, 0.0, 0.5}), point(200.0, 0.9, {0.0, 1.0, 0.5}), point(200.0, 0.1),
                     point(255.0, 0.3)});
    const TexelMap map{255.0, 0.0};
    const ClassificationTable table = tabulate(extinction_knots(f, map, unit), unit, 256);
    ASSERT_EQ(table.entries.size(), 256U);
    for (int value = 0; value < 256; ++value) {
        const glm::dvec4 expected = evaluate(f, value);
        const double sigma = extinction(expected.w, 2.0);
        const glm::dvec4 entry = table.entries[static_cast<std::size_t>(value)];
        const glm::dvec4 product = table.premultiplied[static_cast<std::size_t>(value)];
        expect_near(entry, {glm::dvec3(expected), sigma}, 3e-7 * std::max(1.0, sigma), value);
        expect_near(product, glm::dvec4(glm::dvec3(expected), 1.0) * sigma, 3e-7 * std::max(1.0, sigma),
                    value);
        EXPECT_NEAR(value / 255.0 * table.place.x + table.place.y, value, 1e-9);
    }
}

TEST(ClassificationTable, MixOfEntriesNearsTheFunctionWithTheSquareOfTheirDistance) {
    const TransferFunction f = function_of({point(0.0, 0.0), point(1.0, 0.95, {1.0, 0.0, 0.0})});
    const ExtinctionKnots knots = extinction_knots(f, {}, unit);
    std::vector<double> worst;
    for (const int entries : {129, 257, 513}) {
        const ClassificationTable table = tabulate(knots, unit, entries);
        double most = 0.0;
        for (int i = 0; i <= 10000; ++i) {
            const double texel = i / 10000.0;
            most = std::max(most, std::abs(table.mixed(texel).w - extinction(evaluate(f, texel).w, 2.0)));
        }
        worst.push_back(most);
    }
    EXPECT_NEAR(std::log2(worst[0] / worst[1]), 2.0, 0.15);
    EXPECT_NEAR(std::log2(worst[1] / worst[2]), 2.0, 0.15);
    // The default, on a function that is linear between its entries.
    const ClassificationTable fine = tabulate(knots, unit);
    EXPECT_EQ(fine.entries.size(), static_cast<std::size_t>(table_entries));
    EXPECT_NEAR(fine.mixed(0.7).w, extinction(0.95 * 0.7, 2.0), 1e-6);
    EXPECT_EQ(fine.mixed(-3.0).w, 0.0);
}

bool inside(const std::vector<StoredRange>& ranges, float stored) {
    return std::ranges::any_of(ranges,
                               [&](const StoredRange& r) { return stored >= r.low && stored <= r.high; });
}

TEST(StoredRanges, HoldAllThatAnyEvaluationShows) {
    std::mt19937 random(23);
    for (const TexelMap map : {TexelMap{1.0, -1024.0}, TexelMap{-0.5, 10.0}, TexelMap{3000.0, 0.0}}) {
        for (const TexelRange range : {TexelRange{0.0, 1.0}, TexelRange{-50.0, 4095.0}}) {
            const double a = map.value_of(range.low);
            const double b = map.value_of(range.high);
            for (int round = 0; round < 20; ++round) {
                const TransferFunction f = random_function(random, std::min(a, b), std::max(a, b));
                const ExtinctionKnots knots = extinction_knots(f, map, range);
                const int entries = 64;
                const ClassificationTable table = tabulate(knots, range, entries);
                const std::vector<StoredRange> ranges = stored_ranges(f, map, range, entries);
                const std::vector<StoredRange> narrow = stored_ranges(f, map, range, 0);
                for (int i = 0; i <= 5000; ++i) {
                    const auto stored = static_cast<float>(range.low + (range.high - range.low) * i / 5000.0);
                    const auto at = static_cast<double>(stored);
                    if (evaluate(f, map.value_of(at)).w > 0.0 || knots.evaluate(at).w > 0.0) {
                        EXPECT_TRUE(inside(narrow, stored)) << stored;
                        EXPECT_TRUE(inside(ranges, stored)) << stored;
                    }
                    if (table.mixed(at).w > 0.0) {
                        EXPECT_TRUE(inside(ranges, stored)) << stored;
                    }
                }
                for (std::size_t i = 1; i < ranges.size(); ++i) {
                    EXPECT_LT(ranges[i - 1].high, ranges[i].low);
                }
            }
        }
    }
}

TEST(StoredRanges, AreNoWiderThanTheyMustBe) {
    const TransferFunction f = function_of({point(100.0, 0.0), point(200.0, 0.5), point(300.0, 0.0)});
    const TexelRange range{0.0, 1000.0};
    const std::vector<StoredRange> exact = stored_ranges(f, {1.0, 0.0}, range, 0);
    ASSERT_EQ(exact.size(), 1U);
    EXPECT_LT(exact[0].low, 100.0F);
    EXPECT_NEAR(exact[0].low, 100.0F, 1e-3F);
    EXPECT_NEAR(exact[0].high, 300.0F, 1e-3F);
    const std::vector<StoredRange> tabled = stored_ranges(f, {-1.0, 500.0}, range, 101);
    ASSERT_EQ(tabled.size(), 1U);
    EXPECT_NEAR(tabled[0].low, 190.0F, 1e-2F);
    EXPECT_NEAR(tabled[0].high, 410.0F, 1e-2F);
    EXPECT_TRUE(stored_ranges(function_of({point(1.0, 0.0)}), {}, unit).empty());
    const std::vector<StoredRange> all = stored_ranges(function_of({point(1.0, 0.5)}), {-2.0, 0.0}, unit);
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0].low, -std::numeric_limits<float>::infinity());
    EXPECT_EQ(all[0].high, std::numeric_limits<float>::infinity());
}

TEST(ClassificationTable, SaysWhichEntryIsTheFirstToShowAnything) {
    ClassificationTable table{
        .entries = {glm::vec4(1, 1, 1, 0), glm::vec4(0), glm::vec4(0, 0, 0, 1e-30F), glm::vec4(0)}};
    EXPECT_EQ(table.first_seen(), 2U);
    table.entries[2].a = 0.0F;
    EXPECT_EQ(table.first_seen(), 4U);
    EXPECT_EQ(ClassificationTable{}.first_seen(), 0U);
}

TEST(StoredRanges, OfATableHoldAllThatItsNearestEntryShows) {
    std::mt19937 random(29);
    const TexelMap stored_of_texel{65535.0, -32768.0};
    const TexelRange range{0.25, 0.3125};
    for (int round = 0; round < 40; ++round) {
        const TransferFunction f = random_function(random, 0.0, 1.0);
        const TexelMap map{1.0 / (range.high - range.low), -range.low / (range.high - range.low)};
        const ClassificationTable table = tabulate(extinction_knots(f, map, range), range, 64);
        const std::vector<StoredRange> ranges = stored_ranges(table, range, stored_of_texel);
        int hidden = 0;
        int left_out = 0;
        for (int i = 0; i <= 5000; ++i) {
            // In float, as the shader does, and a little beside.
            const auto texel = static_cast<float>(range.low + (range.high - range.low) * i / 5000.0);
            const float place = texel * static_cast<float>(table.place.x) + static_cast<float>(table.place.y);
            const auto entry = static_cast<std::size_t>(std::clamp(place, 0.0F, 63.0F) + 0.5F);
            const bool seen = table.entries[entry].a > 0.0F;
            const bool held =
                inside(ranges, static_cast<float>(stored_of_texel.value_of(static_cast<double>(texel))));
            EXPECT_TRUE(held || !seen) << texel;
            hidden += seen ? 0 : 1;
            left_out += held ? 0 : 1;
        }
        EXPECT_GE(left_out, hidden * 9 / 10);
    }
}

TEST(StoredRanges, OfATableLeaveOutABackgroundAtAKnot) {
    // Air that is the least value of a CT, where opacity begins to rise.
    const TransferFunction f = function_of({point(-1000.0, 0.0), point(500.0, 0.4)});
    const TexelMap map{65535.0, -32768.0};
    const TexelRange range{static_cast<double>(static_cast<float>(map.texel_of(-1000.0))),
                           static_cast<double>(static_cast<float>(map.texel_of(2400.0)))};
    const std::vector<StoredRange> ranges =
        stored_ranges(tabulate(extinction_knots(f, map, range), range), range, map);
    ASSERT_EQ(ranges.size(), 1U);
    EXPECT_GT(ranges[0].low, -1000.0F);
    EXPECT_LT(ranges[0].low, -999.0F);
    EXPECT_LE(stored_ranges(f, {}, {-1000.0, 2400.0})[0].low, -1000.0F);
}

TEST(Opacity, OfALengthIsThatOfItsParts) {
    for (const double opacity : {0.0, 0.01, 0.4, 0.99}) {
        const double sigma = extinction(opacity, 2.0);
        EXPECT_NEAR(opacity_of(sigma, 2.0), opacity, 1e-15);
        EXPECT_NEAR(opacity_of(sigma, 0.5), 1.0 - std::pow(1.0 - opacity, 0.25), 1e-15);
    }
}

}  // namespace
}  // namespace viscera::volume

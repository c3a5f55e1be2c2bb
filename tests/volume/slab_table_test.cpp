#include "effects/volume/slab_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace viscera::volume {
namespace {

constexpr TexelRange unit_range{0.0, 1.0};

TransferPoint knot(double value, double opacity, glm::dvec3 colour = {0.25, 0.5, 1.0}) {
    return {value, colour, opacity};
}

TransferFunction table_function(std::vector<TransferPoint> points) {
    TransferFunction function;
    function.points = std::move(points);
    function.reference_length_mm = 0.5;
    return function;
}

/// Teeth with upright sides, or with slanted ones.
TransferFunction comb(int teeth, double opacity, bool slanted) {
    std::vector<TransferPoint> points{knot(0.0, 0.0)};
    for (int i = 0; i < teeth; ++i) {
        const double start = (i + 0.3) / teeth;
        const double width = 0.4 / teeth;
        const double side = slanted ? 0.1 / teeth : 0.0;
        const glm::dvec3 colour(i % 2, 0.5, (i % 3) / 2.0);
        points.push_back(knot(start, 0.0, colour));
        points.push_back(knot(start + side, opacity, colour));
        points.push_back(knot(start + width - side, opacity, 1.0 - colour));
        points.push_back(knot(start + width, 0.0, 1.0 - colour));
    }
    points.push_back(knot(1.0, 0.0));
    return table_function(points);
}

struct NamedFunction {
    const char* name;
    TransferFunction function;
};

std::vector<NamedFunction> functions() {
    return {{"ramp", table_function({knot(0.0, 0.0, {1.0, 0.0, 0.3}), knot(1.0, 0.95, {0.0, 1.0, 0.6})})},
            {"fall to nothing", table_function({knot(0.1, 0.999), knot(0.8, 0.0)})},
            {"step", table_function({knot(0.4, 0.1), knot(0.4, 0.8), knot(0.7, 0.8), knot(0.7, 0.0)})},
            {"comb", comb(20, 0.9, false)},
            {"slanted comb", comb(20, 0.97, true)},
            {"fine comb", comb(300, 0.5, false)},
            {"thin", table_function({knot(0.0, 0.0), knot(0.5, 1e-7), knot(1.0, 3e-7)})},
            {"needle", table_function({knot(0.61, 0.0), knot(0.610001, 0.7), knot(0.610002, 0.0)})},
            {"opaque", table_function({knot(0.2, 0.0), knot(0.6, 1.0), knot(1.0, 1.0)})},
            {"constant", table_function({knot(0.5, 0.3)})}};
}

/// Extinction * (red, green, blue, 1).
glm::dvec4 weighted(const ExtinctionKnots& knots, double texel) {
    const glm::dvec4 at = knots.classify(texel);
    return glm::dvec4(glm::dvec3(at), 1.0) * at.w;
}

/// Integral of a smooth function by 5-point Gauss-Legendre quadrature, halved until halving changes nothing.
template <class F>
glm::dvec4 integral(const F& f, double a, double b, double tolerance, int halvings = 40) {
    const auto gauss = [&](double from, double to) {
        constexpr std::array<double, 5> nodes{-0.9061798459386640, -0.5384693101056831, 0.0,
                                              0.5384693101056831, 0.9061798459386640};
        constexpr std::array<double, 5> weights{0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                                0.4786286704993665, 0.2369268850561891};
        glm::dvec4 sum(0.0);
        for (std::size_t k = 0; k < nodes.size(); ++k) {
            sum += f((from + to) / 2.0 + nodes[k] * (to - from) / 2.0) * (weights[k] * (to - from) / 2.0);
        }
        return sum;
    };
    const double middle = (a + b) / 2.0;
    const glm::dvec4 whole = gauss(a, b);
    const glm::dvec4 halves = gauss(a, middle) + gauss(middle, b);
    const glm::dvec4 change = glm::abs(whole - halves);
    if (halvings == 0 || std::max({change.x, change.y, change.z, change.w}) <= tolerance) {
        return halves;
    }
    return integral(f, a, middle, tolerance / 2.0, halvings - 1) +
           integral(f, middle, b, tolerance / 2.0, halvings - 1);
}

/// The mean in double, knot by knot.
glm::dvec4 reference_mean(const ExtinctionKnots& knots, const TexelRange& range, double a, double b) {
    std::vector<double> breaks{range.low, range.high};
    for (const ExtinctionKnots::Knot& knot : knots.knots) {
        breaks.push_back(static_cast<double>(knot.texel));
    }
    std::ranges::sort(breaks);
    breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
    glm::dvec4 sum(0.0);
    for (std::size_t i = 1; i < breaks.size(); ++i) {
        const double start = breaks[i - 1];
        const double end = breaks[i];
        const double from = std::max(a, start);
        const double to = std::min(b, end);
        const auto f = [&](double texel) {
            if (end - start >= SlabTable::step_width(range)) {
                return weighted(knots, texel);
            }
            return glm::mix(weighted(knots, start), weighted(knots, end), (texel - start) / (end - start));
        };
        if (a == b && a >= start && (a < end || i + 1 == breaks.size())) {
            sum = f(a);
        } else if (from < to) {
            sum += integral(f, from, to, 1e-8 * (b - a)) / (b - a);
        }
    }
    return sum;
}

double largest_miss(const glm::vec4& found, const glm::dvec4& expected) {
    const glm::dvec4 miss = glm::abs(glm::dvec4(found) - expected);
    return std::max({miss.x, miss.y, miss.z, miss.w});
}

TEST(SlabTable, MeansAreWithinAHundredThousandthOfTheLargestExtinction) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(0.0, 1.0);
    std::uniform_real_distribution<double> decades(-8.0, 0.0);
    for (const NamedFunction& f : functions()) {
        const ExtinctionKnots knots = extinction_knots(f.function, {}, unit_range);
        const SlabTable table = tabulate_slabs(knots, unit_range);
        const double largest = knots.most_extinction();
        double worst = 0.0;
        for (int i = 0; i < 1500; ++i) {
            const auto a = static_cast<float>(place(random));
            // From equal to as far apart as can be.
            const double distance = i % 10 == 0 ? 0.0 : std::pow(10.0, decades(random));
            const auto b = static_cast<float>(std::min(1.0, static_cast<double>(a) + distance));
            const glm::dvec4 expected =
                reference_mean(knots, unit_range, static_cast<double>(a), static_cast<double>(b));
            worst = std::max(worst, largest_miss(table.mean(a, b), expected));
            EXPECT_EQ(table.mean(a, b), table.mean(b, a));
        }
        RecordProperty(f.name, std::to_string(worst / largest));
        EXPECT_LE(worst, 1e-5 * largest) << f.name << " " << table.pieces;
    }
}

TEST(SlabTable, MeansAroundEveryKnot) {
    for (const NamedFunction& f : functions()) {
        const ExtinctionKnots knots = extinction_knots(f.function, {}, unit_range);
        const SlabTable table = tabulate_slabs(knots, unit_range);
        const double largest = knots.most_extinction();
        for (const ExtinctionKnots::Knot& knot : knots.knots) {
            const float before = std::nextafter(knot.texel, 0.0F);
            const float after = std::nextafter(knot.texel, 1.0F);
            for (const auto& [a, b] : {std::pair{knot.texel, knot.texel}, std::pair{before, knot.texel},
                                       std::pair{knot.texel, after}, std::pair{before, after},
                                       std::pair{before - 1e-4F, after + 2e-4F}}) {
                const auto from = std::max(0.0, static_cast<double>(a));
                const auto to = std::min(1.0, static_cast<double>(b));
                EXPECT_LE(largest_miss(table.mean(static_cast<float>(from), static_cast<float>(to)),
                                       reference_mean(knots, unit_range, from, to)),
                          1e-5 * largest)
                    << f.name << " " << from << " " << to;
            }
        }
    }
}

/// Integral of -log(1 - A) over an interval along which 1 - A goes from y0 to y1.
long double closed_form(long double y0, long double y1, long double width) {
    const auto primitive = [](long double y) { return y > 0.0L ? y * std::log(y) - y : 0.0L; };
    return -width * (primitive(y1) - primitive(y0)) / (y1 - y0);
}

TEST(SlabTable, ExtinctionOfARampIsTheClosedForm) {
    for (const double most : {0.5, 0.99, 1.0}) {
        const TransferFunction f = table_function({knot(0.0, 0.0), knot(1.0, most)});
        const ExtinctionKnots knots = extinction_knots(f, {}, unit_range);
        const SlabTable table = tabulate_slabs(knots, unit_range);
        for (int i = 0; i < 32; ++i) {
            for (int k = i + 1; k <= 32; ++k) {
                const float a = static_cast<float>(i) / 32.0F;
                const float b = static_cast<float>(k) / 32.0F;
                const long double expected = closed_form(1.0L - most * static_cast<long double>(a),
                                                         1.0L - most * static_cast<long double>(b), 1.0L) /
                                             0.5L;
                EXPECT_NEAR(table.mean(a, b).w, static_cast<double>(expected), 1e-5 * knots.most_extinction())
                    << most << " " << a << " " << b;
            }
        }
    }
}

// The function itself instead of the knots made of it: steps may be out of place by 3 roundings.
TEST(SlabTable, MeansAreThoseOfTheFunctionInItsOwnValues) {
    const TransferFunction f = comb(20, 0.9, false);
    TransferFunction in_hu = f;
    for (TransferPoint& p : in_hu.points) {
        p.value = p.value * 4095.0 - 1024.0;
    }
    const ExtinctionKnots knots = extinction_knots(in_hu, {4095.0, -1024.0}, unit_range);
    const SlabTable table = tabulate_slabs(knots, unit_range);
    const double sigma = extinction(0.9, 0.5);
    for (int i = 0; i <= 19; ++i) {
        // Half a tooth, one whole, and all to the right.
        const double start = (i + 0.3) / 20;
        EXPECT_NEAR(table.mean(static_cast<float>(i / 20.0), static_cast<float>(start + 0.01)).w,
                    sigma * 0.01 / 0.025, 1e-4 * sigma);
        EXPECT_NEAR(table.mean(static_cast<float>(i / 20.0), 1.0F).w, sigma * 0.4, 2e-5 * sigma);
        EXPECT_NEAR(table.mean(static_cast<float>(start + 0.005), static_cast<float>(start + 0.006)).w, sigma,
                    1e-5 * sigma);
    }
}

TEST(SlabTable, NothingIsNegativeAndNothingEmptyIsSeen) {
    for (const NamedFunction& f : functions()) {
        const ExtinctionKnots knots = extinction_knots(f.function, {}, unit_range);
        const SlabTable table = tabulate_slabs(knots, unit_range);
        for (int i = 0; i <= 4000; ++i) {
            const float a = static_cast<float>(i) / 4000.0F;
            for (const float b : {a, a + 1e-6F, a + 3e-3F}) {
                const glm::vec4 mean = table.mean(a, b);
                EXPECT_GE(std::min({mean.x, mean.y, mean.z, mean.w}),
                          -3e-6F * static_cast<float>(knots.most_extinction()))
                    << f.name;
            }
        }
    }
    const SlabTable table =
        tabulate_slabs(extinction_knots(comb(20, 0.9, false), {}, unit_range), unit_range);
    EXPECT_EQ(table.mean(0.001F, 0.012F), glm::vec4(0.0F)) << "between teeth nothing at all";
    EXPECT_EQ(table.mean(0.0F, 0.0F), glm::vec4(0.0F));
}

TEST(SlabTable, IsConstantBeyondTheRange) {
    const TransferFunction f = table_function({knot(0.0, 0.2), knot(1.0, 0.6)});
    const SlabTable table = tabulate_slabs(extinction_knots(f, {}, unit_range), unit_range);
    const auto low = static_cast<float>(extinction(0.2, 0.5));
    const auto high = static_cast<float>(extinction(0.6, 0.5));
    EXPECT_FLOAT_EQ(table.mean(-0.5F, -0.25F).w, low);
    EXPECT_FLOAT_EQ(table.mean(-9.0F, -8.0F).w, low);
    EXPECT_FLOAT_EQ(table.mean(1.5F, 1.25F).w, high);
    EXPECT_FLOAT_EQ(table.mean(7.0F, 7.0F).w, high);
    const float inner = table.mean(0.0F, 0.5F).w;
    EXPECT_NEAR(table.mean(-0.5F, 0.5F).w, 0.5F * (low + inner), 1e-6F * high);
    EXPECT_EQ(table.mean(std::numeric_limits<float>::quiet_NaN(), 0.5F), glm::vec4(0.0F));
    EXPECT_TRUE(std::isfinite(table.mean(-std::numeric_limits<float>::infinity(), 0.5F).w));
}

TEST(SlabTable, OtherRanges) {
    std::mt19937 random(5);
    for (const TexelRange range :
         {TexelRange{-1024.0, 3071.0}, TexelRange{1e-4, 3e-4}, TexelRange{-1.0, 0.0}}) {
        const double width = range.high - range.low;
        TransferFunction f = comb(20, 0.9, true);
        for (TransferPoint& p : f.points) {
            p.value = range.low + p.value * width;
        }
        const ExtinctionKnots knots = extinction_knots(f, {}, range);
        const SlabTable table = tabulate_slabs(knots, range);
        std::uniform_real_distribution<double> place(range.low, range.high);
        for (int i = 0; i < 300; ++i) {
            const auto a = static_cast<float>(place(random));
            const auto b = static_cast<float>(place(random));
            const double from = static_cast<double>(std::min(a, b));
            const double to = static_cast<double>(std::max(a, b));
            EXPECT_LE(largest_miss(table.mean(a, b), reference_mean(knots, range, from, to)),
                      1e-5 * knots.most_extinction());
        }
    }
    const SlabTable point_like =
        tabulate_slabs(extinction_knots(comb(3, 0.5, true), {}, {0.5, 0.5}), {0.5, 0.5});
    EXPECT_NEAR(point_like.mean(0.5F, 0.5F).w, static_cast<float>(extinction(0.5, 0.5)), 1e-6F);
}

TEST(SlabTable, StaysSmall) {
    for (const NamedFunction& f : functions()) {
        const SlabTable table = tabulate_slabs(extinction_knots(f.function, {}, unit_range), unit_range);
        RecordProperty(f.name, table.pieces);
        EXPECT_LE(table.pieces, most_slab_pieces) << f.name;
        EXPECT_EQ(table.texels.size(), static_cast<std::size_t>(SlabTable::rows * table.pieces));
        ASSERT_EQ(table.bins.size(), static_cast<std::size_t>(slab_bins));
        EXPECT_EQ(table.bins.front().first, 0);
        EXPECT_EQ(table.bins.back().last, table.pieces - 1);
        int searched = 0;
        for (const SlabTable::Bin& bin : table.bins) {
            EXPECT_LE(bin.first, bin.last);
            EXPECT_LT(bin.last - bin.first, 128) << f.name;
            searched += bin.last - bin.first;
        }
        RecordProperty(std::string(f.name) + ", pieces to choose from beyond one, per bin",
                       std::to_string(searched / static_cast<double>(slab_bins)));
    }
    // What does not fit comes out coarser, but comes out.
    const ExtinctionKnots knots = extinction_knots(comb(1000, 0.9, true), {}, unit_range);
    const SlabTable coarse = tabulate_slabs(knots, unit_range, 64, 300);
    EXPECT_LE(coarse.pieces, 300);
    for (int i = 0; i <= 1000; ++i) {
        const float a = static_cast<float>(i) / 1000.0F;
        const glm::vec4 mean = coarse.mean(a, 1.0F);
        EXPECT_TRUE(mean.w >= 0.0F && static_cast<double>(mean.w) <= 1.01 * knots.most_extinction());
    }
}

}  // namespace
}  // namespace viscera::volume

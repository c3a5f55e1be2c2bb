#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// The film against its closed form, against the same scheme in double precision, across seams, and its
// volume.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr double mobility = 2600.0;  // [1/(mm s)]

/// Liquid of that mobility without drops' leavings and without a rest that stays.
json plain_liquid(double steps_per_s) {
    return {{"viscosity_mpa_s", 1060.0 * 9.80665 / mobility},
            {"residual_mm", 0.0},
            {"trail_mm", 0.0},
            {"steps_per_s", steps_per_s}};
}

/// A slug of blood let go on a vertical wall (F12): once the fan from its rear has met its front, its height
/// is sqrt(x / (G t)) up to the front, whose place follows from the volume.
struct Slug {
    double width_mm = 12.0;
    double height_mm = 0.16;
    [[nodiscard]] double section() const { return width_mm * height_mm; }
    [[nodiscard]] double front(double t) const {
        return std::cbrt(9.0 * section() * section() * mobility / 4.0 * t);
    }
};

struct Profile {
    double front = 0.0;  ///< where the height falls through half of its highest [mm]
    double mean = 0.0;   ///< place of the centre of mass [mm]
    double volume = 0.0;
    double l1 = 0.0;  ///< sum of absolute differences from F12 over the sum
};

Profile profile(BloodStage& stage, double time_s, const Slug& slug) {
    const auto surface = stage.baked();
    const Image height = stage.read("tissue.blood_height");
    Profile result;
    const double front = slug.front(time_s);
    const double highest = std::sqrt(front / (mobility * time_s));
    double last = 0.0;
    double difference = 0.0;
    for (int y = 0; y < stage.size; ++y) {
        for (int x = 0; x < stage.size; ++x) {
            const std::size_t i = surface.index(x, y);
            if (surface.kind[i] != reference::TissueSurface::Texel::cell) {
                continue;
            }
            const double h = height.at(x, y, 0);
            const double p = surface.position[i].x;
            const double volume = h * surface.metric[i].w;
            result.volume += volume;
            result.mean += volume * p;
            const double exact = p < front ? std::sqrt(p / (mobility * time_s)) : 0.0;
            difference += std::abs(h - exact) * surface.metric[i].w;
            if (h > 0.5 * highest) {
                last = std::max(last, p);
            }
        }
    }
    result.mean /= result.volume;
    result.l1 = difference / result.volume;
    result.front = last + 0.5 * surface.metric[0].x;
    return result;
}

constexpr double length_mm = 96.0;
constexpr double side_mm = 6.0;

SurfaceChart strip(double from, double to, glm::dvec2 origin, glm::dvec2 a, glm::dvec2 b) {
    return {.low = {from, 0.0}, .high = {to, side_mm}, .origin_px = origin, .a_px = a, .b_px = b};
}

/// Falls along +x.
BloodStage& set_wall(BloodStage& stage, std::span<const SurfaceChart> charts, double steps_per_s = 200.0) {
    stage.gravity = {{"gravity_m_s2", {9.80665, 0, 0}}, {"spreading", 0.0}};
    stage.blood = {{"liquid", plain_liquid(steps_per_s)}};
    stage.surface(charts, [](glm::dvec2 at) { return glm::dvec3(at, 0.0); });
    return stage;
}

void let_go(BloodStage& stage, const Slug& slug, double time_s) {
    stage.spill([&](const glm::dvec3& p) { return p.x < slug.width_mm ? slug.height_mm : 0.0; });
    stage.run(0.0, time_s, 0.25);
}

TEST(BloodFilm, FallsAsAThinFilmDoes) {
    // 2.4 texels per mm.
    BloodStage stage(256);
    const SurfaceChart chart = strip(0.0, length_mm, {8.0, 8.0}, {2.4, 0.0}, {0.0, 2.4});
    set_wall(stage, std::span(&chart, 1), 240.0);
    const Slug slug;
    for (const double time : {8.0, 14.0}) {
        let_go(stage, slug, time);
        const Profile found = profile(stage, time, slug);
        std::printf(
            "  t %4.1f s: front %.3f mm, F12 %.3f mm (%+.2f %%), heights off by %.2f %%, volume %.6f\n", time,
            found.front, slug.front(time), 100.0 * (found.front / slug.front(time) - 1.0), 100.0 * found.l1,
            found.volume / (slug.section() * side_mm));
        EXPECT_NEAR(found.front / slug.front(time), 1.0, 0.01);
        EXPECT_LT(found.l1, 0.02);
    }
    EXPECT_TRUE(stage.stage().complaints().empty());
}

TEST(BloodFilm, ASeamChangesNothing) {
    const Slug slug;
    constexpr double time = 10.0;
    constexpr double cut = 48.0;
    struct Case {
        const char* name;
        glm::dvec2 origin, a, b;
    };
    const double turn = 0.5;
    const glm::dvec2 turned_a(1.5 * std::cos(turn), 1.5 * std::sin(turn));
    const glm::dvec2 turned_b(-1.5 * std::sin(turn), 1.5 * std::cos(turn));
    BloodStage whole(192);
    const SurfaceChart one = strip(0.0, length_mm, {8.0, 8.0}, {1.5, 0.0}, {0.0, 1.5});
    set_wall(whole, std::span(&one, 1));
    let_go(whole, slug, time);
    const Profile expected = profile(whole, time, slug);
    ASSERT_GT(expected.front, cut + 10.0);
    const auto place = [&](glm::dvec2 at_cut, const glm::dvec2& a) { return at_cut - cut * a; };
    for (const Case& c :
         {Case{"cut", place({8.0, 40.0}, {1.5, 0.0}), {1.5, 0.0}, {0.0, 1.5}},
          Case{"turned by a quarter", place({20.0, 60.0}, {0.0, 1.5}), {0.0, 1.5}, {1.5, 0.0}},
          Case{"mirrored", place({100.0, 40.0}, {-1.5, 0.0}), {-1.5, 0.0}, {0.0, 1.5}},
          Case{"shifted by part of a texel", place({8.37, 40.61}, {1.5, 0.0}), {1.5, 0.0}, {0.0, 1.5}},
          Case{"finer", place({8.0, 40.0}, {1.8, 0.0}), {1.8, 0.0}, {0.0, 1.8}},
          Case{"turned", place({30.0, 40.0}, turned_a), turned_a, turned_b}}) {
        BloodStage stage(192);
        const std::array<SurfaceChart, 2> charts{strip(0.0, cut, {8.0, 8.0}, {1.5, 0.0}, {0.0, 1.5}),
                                                 strip(cut, length_mm, c.origin, c.a, c.b)};
        set_wall(stage, charts);
        let_go(stage, slug, time);
        const Profile found = profile(stage, time, slug);
        std::printf("  %-28s front %.3f (%+.3f mm), centre %.3f (%+.3f %%), volume %+.1e\n", c.name,
                    found.front, found.front - expected.front, found.mean,
                    100.0 * (found.mean / expected.mean - 1.0), found.volume / expected.volume - 1.0);
        EXPECT_NEAR(found.mean / expected.mean, 1.0, 0.005) << c.name;
        // A front lies within a cell of either grid.
        EXPECT_NEAR(found.front, expected.front, 1.0 / 1.5 + 0.005 * expected.front) << c.name;
        whole.stage().make_current();
    }
}

}  // namespace
}  // namespace viscera::test

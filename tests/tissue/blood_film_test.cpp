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
            {"pinning_mm", 0.0},
            {"trail_mm", 0.0},
            {"steps_per_s", steps_per_s}};
}

constexpr double length_mm = 96.0;
constexpr double film_side_mm = 6.0;

/// A slug of blood let go on a vertical wall (F12): once the fan from its rear has met its front, its height
/// is sqrt(x / (G t)) up to the front, whose place follows from the volume.
constexpr double slug_width_mm = 12.0;
constexpr double slug_height_mm = 0.16;
constexpr double section_mm2 = slug_width_mm * slug_height_mm;

double front_at(double t) {
    return std::cbrt(9.0 * section_mm2 * section_mm2 * mobility / 4.0 * t);
}

struct Profile {
    double front = 0.0;  ///< where the mean height across falls through half of its highest [mm]
    double mean = 0.0;   ///< place of the centre of mass [mm]
    double volume = 0.0;
    double l1 = 0.0;  ///< sum of absolute differences from F12 over the sum
};

Profile profile(BloodStage& stage, double time_s) {
    const auto surface = stage.baked();
    const Image height = stage.read("tissue.blood_height");
    Profile result;
    const double front = front_at(time_s);
    const double highest = std::sqrt(front / (mobility * time_s));
    double difference = 0.0;
    constexpr std::size_t bins = 96;
    std::array<double, bins> volume_in{};
    std::array<double, bins> area_in{};
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
            const auto bin = static_cast<std::size_t>(std::clamp(p * bins / length_mm, 0.0, bins - 1.0));
            volume_in[bin] += volume;
            area_in[bin] += surface.metric[i].w;
        }
    }
    result.mean /= result.volume;
    result.l1 = difference / result.volume;
    const auto mean = [&](std::size_t bin) { return volume_in[bin] / area_in[bin]; };
    for (std::size_t bin = 1; bin < bins; ++bin) {
        if (mean(bin - 1) > 0.5 * highest && mean(bin) <= 0.5 * highest) {
            const double share = (mean(bin - 1) - 0.5 * highest) / (mean(bin - 1) - mean(bin));
            result.front = (static_cast<double>(bin) - 0.5 + share) * length_mm / bins;
        }
    }
    return result;
}

SurfaceChart strip(double from, double to, glm::dvec2 origin, glm::dvec2 a, glm::dvec2 b) {
    return {.low = {from, 0.0}, .high = {to, film_side_mm}, .origin_px = origin, .a_px = a, .b_px = b};
}

/// Falls along +x.
BloodStage& set_wall(BloodStage& stage, std::span<const SurfaceChart> charts, double steps_per_s = 200.0) {
    stage.gravity = {{"gravity_m_s2", {9.80665, 0, 0}}, {"spreading", 0.0}};
    stage.blood = {{"liquid", plain_liquid(steps_per_s)}};
    stage.surface(charts, [](glm::dvec2 at) { return glm::dvec3(at, 0.0); });
    return stage;
}

void let_go(BloodStage& stage, double time_s) {
    stage.spill([](const glm::dvec3& p) { return p.x < slug_width_mm ? slug_height_mm : 0.0; });
    stage.run(0.0, time_s, 0.25);
}

TEST(BloodFilm, FallsAsAThinFilmDoes) {
    BloodStage stage(256);
    const SurfaceChart chart = strip(0.0, length_mm, {8.0, 8.0}, {2.5, 0.0}, {0.0, 2.5});
    set_wall(stage, std::span(&chart, 1), 240.0);
    let_go(stage, 8.0);
    for (const double time : {8.0, 12.0}) {
        stage.run(stage.time_s(), time, 0.25);
        const Profile found = profile(stage, time);
        std::printf(
            "  t %4.1f s: front %.3f mm, F12 %.3f mm (%+.2f %%), heights off by %.2f %%, volume %+.1e\n",
            time, found.front, front_at(time), 100.0 * (found.front / front_at(time) - 1.0), 100.0 * found.l1,
            found.volume / (section_mm2 * film_side_mm) - 1.0);
        EXPECT_NEAR(found.front / front_at(time), 1.0, 0.01);
        // Of first order: the front is smeared over some of the 140 cells that it has passed.
        EXPECT_LT(found.l1, 0.03);
    }
    EXPECT_TRUE(stage.stage().complaints().empty());
}

TEST(BloodFilm, ASeamChangesNothing) {
    constexpr double time = 10.0;
    constexpr double cut = 48.0;
    struct Case {
        const char* name;
        glm::dvec2 origin, a, b;
    };
    const double turn = 0.5;
    const glm::dvec2 turned_a(std::cos(turn), std::sin(turn));
    const glm::dvec2 turned_b(-std::sin(turn), std::cos(turn));
    BloodStage whole(128);
    const SurfaceChart one = strip(0.0, length_mm, {8.0, 8.0}, {1.0, 0.0}, {0.0, 1.0});
    set_wall(whole, std::span(&one, 1), 120.0);
    let_go(whole, time);
    const Profile expected = profile(whole, time);
    ASSERT_GT(expected.front, cut + 10.0);
    const auto place = [&](glm::dvec2 at_cut, const glm::dvec2& a) { return at_cut - cut * a; };
    for (const Case& c :
         {Case{"cut", place({8.0, 30.0}, {1.0, 0.0}), {1.0, 0.0}, {0.0, 1.0}},
          Case{"turned by a quarter", place({20.0, 40.0}, {0.0, 1.0}), {0.0, 1.0}, {1.0, 0.0}},
          Case{"mirrored", place({100.0, 30.0}, {-1.0, 0.0}), {-1.0, 0.0}, {0.0, 1.0}},
          Case{"shifted by part of a texel", place({8.37, 30.61}, {1.0, 0.0}), {1.0, 0.0}, {0.0, 1.0}},
          Case{"finer", place({8.0, 30.0}, {1.3, 0.0}), {1.3, 0.0}, {0.0, 1.3}},
          Case{"turned", place({30.0, 40.0}, turned_a), turned_a, turned_b}}) {
        BloodStage stage(128);
        const std::array<SurfaceChart, 2> charts{strip(0.0, cut, {8.0, 8.0}, {1.0, 0.0}, {0.0, 1.0}),
                                                 strip(cut, length_mm, c.origin, c.a, c.b)};
        set_wall(stage, charts, 120.0);
        let_go(stage, time);
        const Profile found = profile(stage, time);
        std::printf("  %-28s front %.3f (%+.2f %%), centre %.3f (%+.3f %%), volume %+.1e\n", c.name,
                    found.front, 100.0 * (found.front / expected.front - 1.0), found.mean,
                    100.0 * (found.mean / expected.mean - 1.0), found.volume / expected.volume - 1.0);
        EXPECT_NEAR(found.mean / expected.mean, 1.0, 0.005) << c.name;
        EXPECT_NEAR(found.front / expected.front, 1.0, 0.005) << c.name;
    }
}

/// How far gutters are from what is shown where they lead [mm], and how many have blood: all, and those that
/// have no cell within two texels.
struct Gutters {
    double off = 0.0;
    int wet = 0;
    int wet_far = 0;
};

Gutters look_at_gutters(BloodStage& stage) {
    const auto surface = stage.baked();
    const Image height = stage.read("tissue.blood_height");
    const Image seam = stage.read("tissue.seam");
    const auto is_cell = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < stage.size && y < stage.size &&
               surface.kind[surface.index(x, y)] == reference::TissueSurface::Texel::cell;
    };
    Gutters result;
    for (int y = 0; y < stage.size; ++y) {
        for (int x = 0; x < stage.size; ++x) {
            const glm::ivec2 to(
                glm::floor(glm::vec2(seam.at(x, y, 0), seam.at(x, y, 1)) * static_cast<float>(stage.size)));
            if (surface.kind[surface.index(x, y)] != reference::TissueSurface::Texel::gutter ||
                !is_cell(to.x, to.y)) {
                continue;
            }
            const double there = height.at(to.x, to.y, 0);
            result.off = std::max(result.off, std::abs(height.at(x, y, 0) - there));
            if (there > 0.02) {
                ++result.wet;
                bool near = false;
                for (int i = 0; i < 25; ++i) {
                    near = near || is_cell(x + i % 5 - 2, y + i / 5 - 2);
                }
                result.wet_far += near ? 0 : 1;
            }
        }
    }
    return result;
}

// Where the first chart ends a block of texels begins two texels on: no step reads what its gutters show.
BloodStage& set_cut_wall(BloodStage& stage) {
    constexpr double cut = 48.0;
    const std::array<SurfaceChart, 2> charts{
        strip(0.0, cut, {6.0, 8.0}, {1.0, 0.0}, {0.0, 1.0}),
        strip(cut, length_mm, {6.0 - cut, 30.0}, {1.0, 0.0}, {0.0, 1.0})};
    return set_wall(stage, charts, 120.0);
}

void expect_gutters(BloodStage& stage, const char* when) {
    const Gutters gutters = look_at_gutters(stage);
    std::printf("  %s: %d gutters with blood, %d of them far from cells, off by %.1e mm at most\n", when,
                gutters.wet, gutters.wet_far, gutters.off);
    // They show what was there before the last step; numbers of 16 bits hold 2e-5 mm of what lies there.
    EXPECT_LT(gutters.off, 2e-3) << when;
    EXPECT_GT(gutters.wet, 15) << when;
    EXPECT_GT(gutters.wet_far, 10) << when;
}

TEST(BloodFilm, GuttersShowWhatLiesAcross) {
    BloodStage stage(128);
    set_cut_wall(stage);
    let_go(stage, 10.0);
    expect_gutters(stage, "as it runs");
}

TEST(BloodFilm, GuttersOfAFilmThatRestsAreDrawnAnew) {
    BloodStage stage(128);
    set_cut_wall(stage);
    stage.blood["liquid"]["residual_mm"] = 0.5;
    // So far past the seam that only gutters far from cells show it.
    stage.spill([](const glm::dvec3& p) { return p.x > 50.0 ? 0.3 + 0.001 * p.x : 0.0; });
    double time = 0.0;
    while (to_string(pass_of(stage.frame(time), "blood").status) != "idle") {
        time += 0.25;
        ASSERT_LT(time, 10.0) << "the film never rests";
    }
    expect_gutters(stage, "at rest");
    stage.load();  // into targets that hold nothing yet
    stage.frame(time);
    expect_gutters(stage, "drawn anew");
}

}  // namespace
}  // namespace viscera::test

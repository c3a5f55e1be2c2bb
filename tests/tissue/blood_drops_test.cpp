#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// Drops against the closed forms of their ways, and the volume of blood, which nothing changes.
namespace viscera::test {
namespace {

using nlohmann::json;
using std::numbers::pi;

constexpr double drop_mm3 = 0.5;
constexpr double aspect = 0.35;

/// Speed of a drop of that volume straight down a wall: of a film as thick as the drop is high [mm/s].
double fall_mm_s(double viscosity_mpa_s) {
    const double radius = std::cbrt(2.0 * drop_mm3 / (pi * aspect));
    const double height = aspect * radius;
    return 1060.0 * 9.80665 / viscosity_mpa_s * height * height / 3.0;
}

/// One drop that leaves nothing behind and never ends.
json one_drop(double viscosity_mpa_s, const glm::dvec3& place) {
    // It is full after one step, and the wound closes.
    return {{"liquid",
             {{"viscosity_mpa_s", viscosity_mpa_s},
              {"trail_mm", 0.0},
              {"drop_life_s", 600.0},
              {"drop_mm3", drop_mm3},
              {"drop_aspect", aspect},
              {"steps_per_s", 120.0},
              {"max_drops", 256}}},
            {"wounds",
             {{{"position_mm", {place.x, place.y, place.z}},
               {"radius_mm", 0.0},
               {"rate_mm3_s", drop_mm3 * 120.0 * 1.01},
               {"stop_s", 1.0 / 120.0}}}}};
}

/// Where the blood is: the centre of mass of its shape.
glm::dvec3 centre(BloodStage& stage) {
    const auto surface = stage.baked();
    const Image height = stage.read("tissue.blood_height");
    glm::dvec3 sum(0.0);
    double mass = 0.0;
    for (std::size_t i = 0; i < surface.kind.size(); ++i) {
        if (surface.kind[i] == reference::TissueSurface::Texel::cell) {
            const int x = static_cast<int>(i % static_cast<std::size_t>(stage.size));
            const int y = static_cast<int>(i / static_cast<std::size_t>(stage.size));
            const double m = surface.metric[i].w * height.at(x, y, 0);
            mass += m;
            sum += m * surface.position[i];
        }
    }
    return sum / mass;
}

TEST(BloodDrops, FallStraightDownAPlane) {
    BloodStage stage(128);
    const SurfaceChart chart{.high = {100.0, 100.0}, .origin_px = {14.0, 14.0}};
    // A plane that leans by 30 degrees, drawn with the texture at an angle.
    const double lean = pi / 6.0;
    const auto place = [&](glm::dvec2 at) {
        const glm::dvec2 p(0.8 * at.x - 0.6 * at.y, 0.6 * at.x + 0.8 * at.y);
        return glm::dvec3(p.x, p.y * std::sin(lean), p.y * std::cos(lean));
    };
    stage.surface(std::span(&chart, 1), place);
    stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
    const double viscosity = 20.0;
    const glm::dvec3 start = place({55.0, 80.0});
    stage.blood = one_drop(viscosity, start);
    stage.load();
    stage.run(0.0, 0.1, 0.1);
    const glm::dvec3 first = centre(stage);
    EXPECT_LT(glm::length(first - start), 2.0);
    stage.run(0.1, 3.1, 0.1);
    const glm::dvec3 way = centre(stage) - first;
    const double expected = 3.0 * fall_mm_s(viscosity) * std::cos(lean);
    std::printf("  fell %.3f mm, expected %.3f mm\n", glm::length(way), expected);
    EXPECT_NEAR(glm::length(way), expected, 0.005 * expected);
    EXPECT_NEAR(way.x, 0.0, 0.02 * expected);
    EXPECT_LT(way.z, 0.0);
    EXPECT_NEAR(stage.account().drops, drop_mm3, 1e-6);
}

TEST(BloodDrops, RunDownACylinderAndASphere) {
    constexpr double radius = 40.0;
    constexpr double viscosity = 20.0;
    // Angle from the top: d theta / dt = (v / R) sin theta, so tan(theta / 2) grows by exp(v t / R).
    const auto angle_after = [&](double from, double time) {
        return 2.0 * std::atan(std::tan(0.5 * from) * std::exp(fall_mm_s(viscosity) * time / radius));
    };
    for (const bool sphere : {false, true}) {
        const auto place = [&](glm::dvec2 at) {
            const double theta = at.y * pi / 180.0;
            const double phi = at.x * pi / 180.0;
            return sphere ? radius * glm::dvec3(std::sin(theta) * std::cos(phi),
                                                std::sin(theta) * std::sin(phi), std::cos(theta))
                          : glm::dvec3(at.x * 0.7, radius * std::sin(theta), radius * std::cos(theta));
        };
        BloodStage stage(160);
        const SurfaceChart chart{.low = {0.0, 15.0},
                                 .high = {60.0, 150.0},
                                 .origin_px = {12.0, -6.0},
                                 .a_px = {1.5, 0.0},
                                 .b_px = {0.0, 1.05},
                                 .cells = {60, 90}};
        stage.surface(std::span(&chart, 1), place);
        stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
        stage.blood = one_drop(viscosity, place({30.0, 40.0}));
        stage.load();
        stage.run(0.0, 0.1, 0.1);
        const auto angle = [&] {
            const glm::dvec3 p = centre(stage);
            return std::atan2(sphere ? std::hypot(p.x, p.y) : p.y, p.z);
        };
        const double from = angle();
        const double time = 3.0;
        stage.run(0.1, 0.1 + time, 0.1);
        const double to = angle();
        std::printf("  %s: from %.2f to %.2f degrees, expected %.2f\n", sphere ? "sphere" : "cylinder",
                    from * 180.0 / pi, to * 180.0 / pi, angle_after(from, time) * 180.0 / pi);
        EXPECT_NEAR(to, angle_after(from, time), 0.01 * (to - from) + 0.005);
        if (sphere) {
            const glm::dvec3 p = centre(stage);
            EXPECT_NEAR(std::atan2(p.y, p.x), pi / 6.0, 0.01);
        }
    }
}

TEST(BloodDrops, GoOnAcrossASeam) {
    for (const bool cut : {false, true}) {
        BloodStage stage(160);
        const SurfaceChart whole{.high = {120.0, 40.0}, .origin_px = {8.0, 8.0}};
        // The second half turned by a quarter, mirrored, and off the grid.
        const std::array<SurfaceChart, 2> halves{SurfaceChart{.high = {60.0, 40.0}, .origin_px = {8.0, 8.0}},
                                                 SurfaceChart{.low = {60.0, 0.0},
                                                              .high = {120.0, 40.0},
                                                              .origin_px = {80.3, -39.4},
                                                              .a_px = {0.0, 1.0},
                                                              .b_px = {1.0, 0.0}}};
        stage.surface(cut ? std::span<const SurfaceChart>(halves) : std::span<const SurfaceChart>(&whole, 1),
                      [](glm::dvec2 at) { return glm::dvec3(at, 0.0); });
        stage.gravity = {{"gravity_m_s2", {0.8 * 9.80665, 0.2 * 9.80665, 0.0}}};
        stage.blood = one_drop(20.0, {20.0, 10.0, 0.0});
        stage.load();
        stage.run(0.0, 0.1, 0.1);
        const glm::dvec3 first = centre(stage);
        stage.run(0.1, 6.1, 0.1);
        const glm::dvec3 way = centre(stage) - first;
        const double strength = std::hypot(0.8, 0.2);
        const double expected = 6.0 * fall_mm_s(20.0) * strength;
        ASSERT_GT(first.x + way.x, 62.0);
        std::printf("  %s: fell %.3f mm, expected %.3f mm\n", cut ? "cut" : "whole", glm::length(way),
                    expected);
        EXPECT_NEAR(glm::length(way), expected, 0.01 * expected);
        EXPECT_NEAR(std::atan2(way.y, way.x), std::atan2(0.2, 0.8), 0.015);
        EXPECT_NEAR(stage.account().drops, drop_mm3, 1e-6);
    }
}

TEST(BloodDrops, LargeOnesAreSeenWholeAcrossASeam) {
    // 17 texels from middle to edge, with its middle a little before the seam.
    const auto plane = [](glm::dvec2 at) { return glm::dvec3(at, 0.0); };
    const SurfaceChart whole{.high = {96.0, 96.0}, .cells = {24, 24}};
    const std::array<SurfaceChart, 2> cut{
        SurfaceChart{.high = {48.0, 96.0}, .cells = {12, 24}},
        SurfaceChart{.low = {48.0, 0.0}, .high = {96.0, 96.0}, .origin_px = {20.0, 8.0}, .cells = {12, 24}}};
    std::array<double, 2> seen{};
    for (std::size_t i = 0; i < 2; ++i) {
        BloodStage stage(128);
        stage.surface(i == 0 ? std::span(&whole, 1) : std::span(cut), plane);
        stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
        stage.blood = {{"liquid", {{"drop_mm3", 800.0}, {"drop_aspect", 0.1}, {"max_drops", 256}}},
                       {"wounds",
                        {{{"position_mm", {45.5, 48.5, 0}},
                          {"radius_mm", 0.0},
                          {"rate_mm3_s", 120.0 * 800.0},
                          {"stop_s", 1.0 / 120.0}}}}};
        stage.load();
        stage.run(0.0, 1.0 / 120.0, 1.0 / 120.0);
        const auto surface = stage.baked();
        const Image height = stage.read("tissue.blood_height");
        for (int y = 0; y < stage.size; ++y) {
            for (int x = 0; x < stage.size; ++x) {
                const bool cell = surface.kind[surface.index(x, y)] == reference::TissueSurface::Texel::cell;
                seen[i] += cell ? static_cast<double>(height.at(x, y, 0)) : 0.0;
            }
        }
    }
    std::printf("  seen whole: %.1f mm^3, across a seam: %.1f mm^3\n", seen[0], seen[1]);
    EXPECT_GT(seen[0], 600.0);
    EXPECT_NEAR(seen[1] / seen[0], 1.0, 0.01);
}

TEST(BloodDrops, TheTrailOfManyDropsIsSmooth) {
    // Down a wall, with texels of 0.25 mm: drops are some 3 mm across.
    BloodStage stage(128);
    const SurfaceChart chart{
        .high = {28.0, 28.0}, .origin_px = {8.0, 8.0}, .a_px = {4.0, 0.0}, .b_px = {0.0, 4.0}};
    stage.surface(std::span(&chart, 1), [](glm::dvec2 at) { return glm::dvec3(at, 0.0); });
    stage.gravity = {{"gravity_m_s2", {0.0, -9.80665, 0.0}}};
    stage.blood = {{"liquid", {{"max_drops", 1024}}},
                   {"wounds", {{{"position_mm", {14, 24, 0}}, {"rate_mm3_s", 110.0}}}}};
    stage.load();
    stage.run(0.0, 2.0, 0.1);
    const Image height = stage.read("tissue.blood_height");
    double rough = 0.0;
    double sum = 0.0;
    // Between the wound and the lower border.
    for (int y = 24; y < 88; ++y) {
        for (int x = 24; x < 104; ++x) {
            const double mean = 0.25 * (static_cast<double>(height.at(x - 1, y, 0)) + height.at(x + 1, y, 0) +
                                        height.at(x, y - 1, 0) + height.at(x, y + 1, 0));
            rough += std::abs(height.at(x, y, 0) - mean);
            sum += height.at(x, y, 0);
        }
    }
    std::printf("  texels differ from those around by %.1f %% of the film\n", 100.0 * rough / sum);
    EXPECT_GT(sum, 5.0);
    EXPECT_LT(rough / sum, 0.05);
}

/// A trough: blood runs into it from the side and stays.
glm::dvec3 trough(glm::dvec2 at) {
    const glm::dvec2 c = at - 30.0;
    return {c.x, c.y, 0.012 * glm::dot(c, c) + 0.3 * std::sin(0.5 * c.x) * std::cos(0.4 * c.y)};
}

BloodStage& set_trough(BloodStage& stage, double scale_px) {
    const SurfaceChart chart{.high = {60.0, 60.0},
                             .origin_px = {5.0, 5.0},
                             .a_px = {scale_px, 0.0},
                             .b_px = {0.0, scale_px},
                             .cells = {30, 30}};
    stage.surface(std::span(&chart, 1), trough);
    stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
    return stage;
}

TEST(BloodVolume, IsKeptForTenThousandSteps) {
    BloodStage stage(61);  // no multiple of a block's side
    set_trough(stage, 0.9);
    stage.gravity["open_edges"] = false;
    stage.blood = {{"liquid", {{"steps_per_s", 500.0}, {"max_drops", 1024}}}};
    // A ring of film that runs together, for as long as it takes.
    stage.spill([](const glm::dvec3& p) { return std::hypot(p.x, p.y) > 15.0 ? 0.3 : 0.0; });
    stage.frame(0.0);
    const double start = stage.account().film;
    for (int i = 1; i <= 40; ++i) {
        stage.frame(0.5 * i);  // 250 steps
    }
    const BloodAccount end = stage.account();
    std::printf("  %.6f mm^3 at the start, drift %+.2e after 10000 steps\n", start, end.film / start - 1.0);
    EXPECT_NEAR(end.film / start, 1.0, 1e-6);
    EXPECT_EQ(end.gone, 0.0);
}

TEST(BloodVolume, IsKeptWhereACreepingFilmMeetsOneThatIsDisturbed) {
    // It gets thinner everywhere by 3e-4 mm/s at most, so tiles rest through which blood passes.
    const SurfaceChart chart{.high = {240.0, 24.0}, .cells = {60, 6}};
    BloodStage stage(256);
    stage.surface(std::span(&chart, 1), [](glm::dvec2 at) { return glm::dvec3(at, -0.05 * at.x); });
    stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}, {"open_edges", false}};
    stage.blood = {{"liquid", {{"steps_per_s", 120.0}, {"max_drops", 1024}}},
                   {"wounds", {{{"position_mm", {70, 12, -3.5}}, {"rate_mm3_s", 20.0}, {"start_s", 1.0}}}}};
    stage.spill([](const glm::dvec3& p) { return 0.06 + 2e-4 * p.x; });
    stage.frame(0.0);
    const double start = stage.account().film;
    stage.run(0.0, 5.0, 0.1);
    const BloodAccount end = stage.account();
    const double off = end.kept() / (start + end.given) - 1.0;
    std::printf("  %.3f mm^3 at the start, %.3f given, off by %+.1e\n", start, end.given, off);
    EXPECT_NEAR(off, 0.0, 1e-6);
}

TEST(BloodVolume, IsAccountedForWhateverHappens) {
    BloodStage stage(64);
    set_trough(stage, 0.9);
    stage.blood = {
        {"liquid",
         {{"steps_per_s", 120.0}, {"drying_mm_s", 0.001}, {"max_drops", 1024}, {"drop_life_s", 3.0}}},
        {"wounds",
         {{{"position_mm", {-18, 5, 8}}, {"rate_mm3_s", 60.0}},
          // Beyond the rim: it runs off.
          {{"position_mm", {29, 27, 20}}, {"rate_mm3_s", 40.0}, {"radius_mm", 2.0}},
          {{"position_mm", {0, 22, 6}}, {"rate_mm3_s", 900.0}, {"stop_s", 0.5}}}},
        {"tools",
         {{{"kind", "suction"}, {"position_mm", {0, 0, 0}}, {"radius_mm", 6}, {"rate", 60}, {"start_s", 4}},
          {{"kind", "rinse"},
           {"position_mm", {-12, 4, 2}},
           {"radius_mm", 5},
           {"rate", 0.5},
           {"start_s", 6}}}}};
    stage.load();
    BloodAccount account;
    for (const double until : {2.0, 5.0, 8.5}) {  // 1020 steps
        stage.run(stage.time_s(), until, 0.05);
        account = stage.account();
        std::printf("  t %.1f s: given %.3f = film %.3f + drops %.3f + gone %.3f mm^3, off by %+.1e\n", until,
                    account.given, account.film, account.drops, account.gone,
                    account.kept() / account.given - 1.0);
        EXPECT_NEAR(account.kept() / account.given, 1.0, 1e-3);
    }
    // 60 and 40 mm^3/s all the time, 900 for half a second, in whole drops.
    EXPECT_NEAR(account.given, 100.0 * 8.5 + 450.0, 2.0);
    EXPECT_GT(account.film, 0.0);
    EXPECT_GT(account.drops, 0.0);
    EXPECT_GT(account.gone, 0.0);
    EXPECT_TRUE(stage.stage().complaints().empty());
}

TEST(BloodVolume, OldDropsMakeRoomForNewOnes) {
    BloodStage stage(64);
    const SurfaceChart chart{
        .high = {60.0, 60.0}, .origin_px = {5.0, 5.0}, .a_px = {0.9, 0.0}, .b_px = {0.0, 0.9}};
    stage.surface(std::span(&chart, 1), [](glm::dvec2 at) { return glm::dvec3(at, 0.0); });
    // Thick blood on a wall: no drop ends of itself in this time.
    stage.gravity = {{"gravity_m_s2", {1.0, 0.0, 0.0}}};
    stage.blood = {
        {"liquid",
         {{"max_drops", 256}, {"drop_mm3", 0.0078125}, {"viscosity_mpa_s", 40.0}, {"trail_mm", 0.0}}},
        {"wounds", {{{"position_mm", {20, 30, 0}}, {"rate_mm3_s", 4.0}, {"radius_mm", 8.0}}}}};
    stage.load();
    stage.run(0.0, 2.0, 0.1);
    const BloodAccount account = stage.account();
    std::printf("  given %.4f = film %.4f + drops %.4f mm^3\n", account.given, account.film, account.drops);
    EXPECT_NEAR(account.given, 8.0, 0.1);
    EXPECT_NEAR(account.kept() / account.given, 1.0, 1e-6);
    EXPECT_GT(account.film, 2.0);
    EXPECT_LE(account.drops, 256 * 0.0078125);
}

}  // namespace
}  // namespace viscera::test

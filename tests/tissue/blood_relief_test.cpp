#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// Blood in the hollows of a relief, and edges that are pinned, against closed forms.
namespace viscera::test {
namespace {

using nlohmann::json;
using Texel = reference::TissueSurface::Texel;

constexpr double pull = 8.0;

json liquid(double pinning_mm) {
    return {{"residual_mm", 0.0}, {"pinning_mm", pinning_mm}, {"trail_mm", 0.0}, {"steps_per_s", 120.0}};
}

void set_sheet(BloodStage& stage, const glm::dvec3& gravity, std::span<const SurfaceChart> charts,
               double pinning_mm) {
    stage.gravity = {{"gravity_m_s2", {gravity.x, gravity.y, gravity.z}}, {"relief_pull", pull}};
    stage.blood = {{"liquid", liquid(pinning_mm)}};
    stage.surface(charts, [](glm::dvec2 at) { return glm::dvec3(at, 0.0); });
}

TEST(BloodRelief, FillsHollowsToOneLevel) {
    // On level ground a film comes to rest where its height and the relief's pull are the same everywhere.
    BloodStage stage(64);
    const SurfaceChart chart{.high = {40.0, 40.0}, .origin_px = {8.0, 8.0}, .cells = {4, 4}};
    set_sheet(stage, {0, 0, -9.80665}, std::span(&chart, 1), 0.0);
    stage.gravity["open_edges"] = false;
    const auto height = [](const glm::dvec3& p) { return 0.03 * std::cos(0.6 * p.x) * std::cos(0.5 * p.y); };
    stage.relief(height);
    stage.spill([](const glm::dvec3&) { return 0.6; });
    stage.run(0.0, 12.0, 0.5);
    const auto surface = stage.baked();
    const Image blood = stage.read("tissue.blood_height");
    std::array<double, 2> level{1e9, -1e9};
    for (std::size_t i = 0; i < surface.kind.size(); ++i) {
        if (surface.kind[i] == Texel::cell) {
            const double h = blood.at(static_cast<int>(i % 64), static_cast<int>(i / 64), 0);
            const double sum = h + pull * height(surface.position[i]);
            level = {std::min(level[0], sum), std::max(level[1], sum)};
        }
    }
    std::printf("  level from %.5f to %.5f mm\n", level[0], level[1]);
    // From 0.48 mm; tiles rest in which nothing changes by more than 0.5 um/s.
    EXPECT_LT(level[1] - level[0], 0.004);
    EXPECT_NEAR(level[0], 0.6, 0.02);
    EXPECT_NEAR(stage.account().kept() / (0.6 * 40.0 * 40.0), 1.0, 1e-5);
}

TEST(BloodRelief, ARampTurnsDownhill) {
    // The texture lies askew on a slope; a relief that rises evenly tilts it, by as much in space as there.
    BloodStage stage(128);
    const SurfaceChart& chart = askew_chart;
    const glm::dvec3 gravity(4.0, -3.0, -8.0);
    set_sheet(stage, gravity, std::span(&chart, 1), 0.0);
    const glm::dvec2 ramp(0.02, 0.05);
    stage.relief([&](const glm::dvec3& p) { return glm::dot(ramp, glm::dvec2(p)); });
    stage.frame(0.0);
    const glm::dvec2 fall = glm::dvec2(glm::normalize(gravity)) - pull * ramp;
    const glm::dvec2 uv = glm::normalize((fall.x * chart.a_px + fall.y * chart.b_px) / 128.0);
    const Image map = stage.read("tissue.gravity");
    const auto surface = stage.baked();
    double worst = 0.0;
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) {
            if (surface.at(x, y) == Texel::cell) {
                worst = std::max({worst, std::abs(map.at(x, y, 0) - uv.x), std::abs(map.at(x, y, 1) - uv.y),
                                  std::abs(map.at(x, y, 2) - glm::length(fall))});
            }
        }
    }
    std::printf("  off by %.1e at most\n", worst);
    // Heights of the relief are whole multiples of 2^-23, of which steps of half a millimetre see 1e-5.
    EXPECT_LT(worst, 2e-4);
}

/// Centre of what flows down a wall with a relief, and its volume.
glm::dvec2 flow_down(std::span<const SurfaceChart> charts) {
    BloodStage stage(128);
    set_sheet(stage, {9.80665, 0, 0}, charts, 0.1);
    stage.relief([](const glm::dvec3& p) { return 0.04 * std::sin(0.5 * p.x + 1.0) * std::cos(0.45 * p.y); });
    stage.spill([](const glm::dvec3& p) { return p.x < 12.0 ? 0.3 : 0.0; });
    stage.run(0.0, 6.0, 0.25);
    const auto surface = stage.baked();
    const Image blood = stage.read("tissue.blood_height");
    glm::dvec2 sum(0.0);
    for (std::size_t i = 0; i < surface.kind.size(); ++i) {
        if (surface.kind[i] == Texel::cell) {
            const double volume =
                blood.at(static_cast<int>(i % 128), static_cast<int>(i / 128), 0) * surface.metric[i].w;
            sum += volume * glm::dvec2(surface.position[i].x, 1.0);
        }
    }
    return {sum.x / sum.y, sum.y};
}

TEST(BloodRelief, ASeamChangesNothing) {
    constexpr double cut = 48.0;
    const SurfaceChart one{.high = {96.0, 24.0}, .origin_px = {8.0, 8.0}};
    const glm::dvec2 whole = flow_down(std::span(&one, 1));
    struct Case {
        const char* name;
        glm::dvec2 origin, a, b;
    };
    for (const Case& c : {Case{"cut", {-40.0, 60.0}, {1.0, 0.0}, {0.0, 1.0}},
                          Case{"turned by a quarter", {70.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}},
                          Case{"finer", {8.0 - 1.3 * cut, 60.0}, {1.3, 0.0}, {0.0, 1.3}}}) {
        const std::array<SurfaceChart, 2> charts{
            SurfaceChart{.high = {cut, 24.0}, .origin_px = {8.0, 8.0}},
            SurfaceChart{
                .low = {cut, 0.0}, .high = {96.0, 24.0}, .origin_px = c.origin, .a_px = c.a, .b_px = c.b}};
        const glm::dvec2 found = flow_down(charts);
        std::printf("  %-20s centre %.3f of %.3f mm (%+.3f %%), volume %+.1e\n", c.name, found.x, whole.x,
                    100.0 * (found.x / whole.x - 1.0), found.y / whole.y - 1.0);
        EXPECT_NEAR(found.x / whole.x, 1.0, 0.005) << c.name;
    }
}

TEST(BloodRelief, AFlatOneChangesNoBit) {
    std::array<std::vector<std::byte>, 2> gravity;
    std::array<std::vector<std::byte>, 2> blood;
    for (std::size_t i = 0; i < 2; ++i) {
        BloodStage stage(96);
        const SurfaceChart chart{.high = {40.0, 40.0}, .origin_px = {8.0, 8.0}, .a_px = {1.0, 0.2}};
        set_sheet(stage, {3.0, 1.0, -9.0}, std::span(&chart, 1), 0.1);
        stage.blood["wounds"] = {{{"position_mm", {10, 10, 0}}, {"rate_mm3_s", 300.0}}};
        if (i == 1) {
            stage.relief([](const glm::dvec3&) { return 0.0; });
        } else {
            stage.load();
        }
        const FrameReport& report = stage.run(0.0, 1.0, 0.1);
        EXPECT_EQ(to_string(pass_of(report, "gravity").status), "cached");
        gravity[i] = stage.read("tissue.gravity").data;
        blood[i] = stage.read("tissue.blood_height").data;
    }
    EXPECT_EQ(gravity[0], gravity[1]);
    EXPECT_EQ(blood[0], blood[1]);
}

TEST(BloodRelief, NoReliefMakesBloodLoseItsHead) {
    // Cliffs, holes without end, and what is no number, at the strongest pull.
    BloodStage stage(64);
    const SurfaceChart chart{.high = {48.0, 48.0}, .origin_px = {8.0, 8.0}};
    set_sheet(stage, {3.0, 1.0, -9.0}, std::span(&chart, 1), 0.2);
    stage.gravity["relief_pull"] = 100.0;
    stage.blood["wounds"] = {{{"position_mm", {20, 20, 0}}, {"rate_mm3_s", 500.0}},
                             {{"position_mm", {30, 35, 0}}, {"rate_mm3_s", 500.0}}};
    stage.relief([](const glm::dvec3& p) {
        const int place = static_cast<int>(p.x) * 7 + static_cast<int>(p.y) * 3;
        return place % 5 == 0    ? 5000.0
               : place % 11 == 0 ? -1e30
               : place % 13 == 0 ? std::nan("")
                                 : 0.1 * (place % 3);
    });
    stage.run(0.0, 2.0, 0.1);
    for (const char* target :
         {"tissue.gravity", "tissue.blood_height", "tissue.blood_color", "tissue.blood_normal"}) {
        for (const float value : to_floats(stage.read(target))) {
            ASSERT_TRUE(std::isfinite(value)) << target;
        }
    }
    const BloodAccount account = stage.account();
    EXPECT_NEAR(account.given, 2000.0, 10.0);
    EXPECT_NEAR(account.kept() / account.given, 1.0, 1e-5);
}

/// A pool of 10 mm in a trough of 40 mm. `cut`: where its edge is, one chart ends and another begins.
void expect_pinned(double height, bool cut) {
    SCOPED_TRACE(cut ? "at a seam" : "in one chart");
    constexpr double pinning = 0.2;
    constexpr double width = 6.0;
    constexpr int shift = 8;  // of the second chart [texels]
    BloodStage stage(64);
    const std::array<SurfaceChart, 2> charts{
        SurfaceChart{.high = {cut ? 10.0 : 40.0, width}, .origin_px = {8.0, 8.0}},
        SurfaceChart{.low = {10.0, 0.0}, .high = {40.0, width}, .origin_px = {8.0 + shift, 8.0}}};
    const auto column = [&](int mm) { return 8 + mm + (cut && mm >= 10 ? shift : 0); };
    set_sheet(stage, {0, 0, -9.80665}, std::span(charts).first(cut ? 2 : 1), pinning);
    stage.spill([&](const glm::dvec3& p) { return p.x < 10.0 ? height : 0.0; });
    stage.frame(0.0);
    const Image before = stage.read("tissue.blood_height");
    stage.run(0.0, 40.0, 0.5);
    const Image after = stage.read("tissue.blood_height");
    EXPECT_NEAR(stage.account().kept() / (10.0 * width * height), 1.0, 1e-5);
    if (height < pinning) {
        for (int mm = 0; mm < 40; ++mm) {
            EXPECT_EQ(before.at(column(mm), 11, 0), after.at(column(mm), 11, 0)) << mm << " mm";
        }
        return;
    }
    int wet = 0;
    for (int mm = 0; mm < 40; ++mm) {
        wet += after.at(column(mm), 11, 0) > 0.25F * static_cast<float>(pinning) ? 1 : 0;
    }
    std::printf("  %.3f mm high and %d mm long\n", after.at(10, 11, 0), wet);
    // What is little higher creeps with the cube of the difference.
    EXPECT_GT(after.at(10, 11, 0), pinning);
    EXPECT_LT(after.at(10, 11, 0), 1.2 * pinning);
    EXPECT_NEAR(wet, 10.0 * height / after.at(10, 11, 0), 1.0);
    EXPECT_EQ(after.at(column(wet + 1), 11, 0), 0.0F);
}

TEST(BloodPinning, APoolSpreadsUntilItsEdgeHolds) {
    // Lower than that it stays where it is, to the bit; higher it spreads until it is hardly higher.
    for (const double height : {0.19, 0.6}) {
        expect_pinned(height, false);
        expect_pinned(height, true);
    }
}

}  // namespace
}  // namespace viscera::test

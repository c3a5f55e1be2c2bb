#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// Blood on surfaces that collapse for a while, and at the borders of the texture.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int patch_cells = 20;
constexpr double patch_side_mm = 60.0;

glm::dvec3 deep_trough(glm::dvec2 at) {
    return {at.x, at.y, 0.02 * (at.y - 30.0) * (at.y - 30.0)};
}

SurfaceChart chart_of(double px_per_mm, double origin_px) {
    return {.high = {patch_side_mm, patch_side_mm},
            .origin_px = {origin_px, origin_px},
            .a_px = {px_per_mm, 0.0},
            .b_px = {0.0, px_per_mm},
            .cells = {patch_cells, patch_cells}};
}

/// The host's vertices; `pulled`: those in the middle lie in one point.
std::vector<float> vertices(bool pulled) {
    std::vector<float> places;
    for (int y = 0; y <= patch_cells; ++y) {
        for (int x = 0; x <= patch_cells; ++x) {
            const bool middle = x >= 6 && x <= 14 && y >= 6 && y <= 14;
            const glm::dvec2 at =
                patch_side_mm / patch_cells * (pulled && middle ? glm::dvec2(10.0) : glm::dvec2(x, y));
            for (int k = 0; k < 3; ++k) {
                places.push_back(static_cast<float>(deep_trough(at)[k]));
            }
        }
    }
    return places;
}

TEST(BloodSurface, WhatLiesOnTrianglesThatCollapseComesBackWithThem) {
    // A film alone, and drops that run over it.
    for (const bool bleeds : {false, true}) {
        BloodStage stage(64);
        const SurfaceChart chart = chart_of(0.9, 5.0);
        stage.surface(std::span(&chart, 1), deep_trough);
        stage.mesh["host_positions"] = "organ";
        stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
        stage.blood["liquid"] = {{"max_drops", 1024}};
        if (bleeds) {
            const glm::dvec3 p = deep_trough({30.0, 40.0});
            stage.blood["wounds"] = {
                {{"position_mm", {p.x, p.y, p.z}}, {"rate_mm3_s", 120.0}, {"radius_mm", 4.0}}};
        }
        stage.spill([](const glm::dvec3&) { return 0.05; });
        HostValues values;
        const auto frame = [&](double time, bool pulled) {
            values.set("organ", vertices(pulled));
            stage.frame(time, &values);
            expect_finite(stage);
            return stage.account();
        };
        const double start = frame(0.0, false).kept();
        EXPECT_GT(start, 100.0);
        const BloodAccount before = frame(0.5, false);
        for (int i = 1; i <= 12; ++i) {
            const bool pulled = i % 4 == 1 || i > 9;
            const BloodAccount account = frame(0.5 + 0.05 * i, pulled);
            EXPECT_NEAR(account.kept() / (start + account.given), 1.0, 1e-5) << "frame " << i;
        }
        const BloodAccount after = frame(1.2, false);
        std::printf("  given %.3f, film %.3f before and %.3f after, drops %.3f, gone %.3f mm^3\n",
                    after.given, before.film, after.film, after.drops, after.gone);
        EXPECT_NEAR(after.kept() / (start + after.given), 1.0, 1e-5);
        EXPECT_LT(after.gone, 0.1 * start);
        EXPECT_EQ(after.drops > 0.0, bleeds);
    }
}

/// Where the blood is in the texture, from 0 to 1.
glm::dvec2 middle_of_blood(BloodStage& stage) {
    const Image height = stage.read("tissue.blood_height");
    glm::dvec2 sum(0.0);
    double mass = 0.0;
    for (int y = 0; y < stage.size; ++y) {
        for (int x = 0; x < stage.size; ++x) {
            const double h = height.at(x, y, 0);
            mass += h;
            sum += h * (glm::dvec2(x, y) + 0.5) / static_cast<double>(stage.size);
        }
    }
    return sum / mass;
}

TEST(BloodSurface, WoundsAtTheTexturesUpperAndRightBorderBleedThere) {
    for (const bool upper : {true, false}) {
        BloodStage stage(64);
        const SurfaceChart chart = chart_of(64.0 / patch_side_mm, 0.0);
        stage.surface(std::span(&chart, 1), [](glm::dvec2 at) { return glm::dvec3(at, 0.0); });
        stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}, {"open_edges", false}};
        const glm::dvec2 at = upper ? glm::dvec2(30.0, 61.0) : glm::dvec2(61.0, 30.0);
        stage.blood = {
            {"liquid", {{"max_drops", 256}}},
            {"wounds", {{{"position_mm", {at.x, at.y, 0}}, {"rate_mm3_s", 60.0}, {"radius_mm", 0.0}}}}};
        stage.load();
        stage.run(0.0, 0.2, 0.1);
        EXPECT_GT(stage.account().given, 5.0);
        const glm::dvec2 middle = middle_of_blood(stage);
        EXPECT_GT(upper ? middle.y : middle.x, 0.9);
        EXPECT_NEAR(upper ? middle.x : middle.y, 0.5, 0.02);
    }
}

}  // namespace
}  // namespace viscera::test

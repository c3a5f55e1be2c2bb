#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// What blood looks like, against its formulas in double precision.
namespace viscera::test {
namespace {

using nlohmann::json;
using Texel = reference::TissueSurface::Texel;

TEST(BloodPicture, ColourAndNormalFollowFromTheHeight) {
    BloodStage stage(128);
    // The texture lies askew on the plane, and is stretched.
    stage.surface(std::span(&askew_chart, 1), [](glm::dvec2 p) { return glm::dvec3(p, 0.0); });
    const glm::dvec3 extinction(1.5, 11.0, 6.0);
    const glm::dvec3 deep(0.3, 0.05, 0.1);
    constexpr double covering = 0.2;
    constexpr double bump = 1.7;
    stage.blood["look"] = {{"extinction_per_mm", {extinction.x, extinction.y, extinction.z}},
                           {"deep_colour", {deep.x, deep.y, deep.z}},
                           {"covering_mm", covering},
                           {"bump", bump}};
    stage.spill([](const glm::dvec3& p) {
        return std::max(0.0, 0.25 + 0.2 * std::sin(0.5 * p.x) * std::cos(0.4 * p.y) + 0.01 * (p.x - 20.0));
    });
    json scene = stage.scene();
    for (const char* target : {"tissue.blood_color", "tissue.blood_normal"}) {
        scene["targets"][target]["format"] = "rgba32f";
    }
    stage.stage().load(scene);
    stage.frame(0.0);
    const auto surface = stage.baked();
    const Image height = stage.read("tissue.blood_height");
    const Image colour = stage.read("tissue.blood_color");
    const Image normal = stage.read("tissue.blood_normal");
    const auto is_cell = [&](int x, int y) { return surface.kind[surface.index(x, y)] == Texel::cell; };
    const auto h = [&](int x, int y) { return static_cast<double>(height.at(x, y, 0)); };
    int looked_at = 0;
    double steepest = 0.0;
    double worst_colour = 0.0;
    double worst_normal = 0.0;
    for (int y = 1; y < stage.size - 1; ++y) {
        for (int x = 1; x < stage.size - 1; ++x) {
            if (!is_cell(x, y) || !is_cell(x - 1, y) || !is_cell(x + 1, y) || !is_cell(x, y - 1) ||
                !is_cell(x, y + 1)) {
                continue;
            }
            ++looked_at;
            for (int k = 0; k < 3; ++k) {
                // Beer-Lambert: what comes through, and what the blood itself gives back.
                const double through = std::exp(-extinction[k] * h(x, y));
                worst_colour = std::max(worst_colour,
                                        std::abs(colour.at(x, y, k) - (through + deep[k] * (1.0 - through))));
            }
            worst_colour =
                std::max(worst_colour, std::abs(colour.at(x, y, 3) - (1.0 - std::exp(-h(x, y) / covering))));
            const glm::dvec4& metric = surface.metric[surface.index(x, y)];
            const glm::dvec2 slope(bump * 0.5 * (h(x + 1, y) - h(x - 1, y)) / metric.x,
                                   bump * 0.5 * (h(x, y + 1) - h(x, y - 1)) / metric.y);
            const glm::dvec3 expected = glm::normalize(glm::dvec3(-slope, 1.0));
            steepest = std::max(steepest, glm::length(slope));
            for (int k = 0; k < 3; ++k) {
                worst_normal = std::max(worst_normal, std::abs(normal.at(x, y, k) - expected[k]));
            }
        }
    }
    std::printf("  %d texels, slopes up to %.2f: colour off by %.1e, normal by %.1e\n", looked_at, steepest,
                worst_colour, worst_normal);
    EXPECT_GT(looked_at, 4000);
    EXPECT_GT(steepest, 0.1);
    EXPECT_LT(worst_colour, 2e-6);
    EXPECT_LT(worst_normal, 2e-6);
}

TEST(BloodPicture, ADropIsRoundOnTheSurfaceNotInTheTexture) {
    BloodStage stage(128);
    // Texels of 0.35 x 1.1 mm, skewed.
    const SurfaceChart chart{
        .high = {40.0, 60.0}, .origin_px = {12.0, 10.0}, .a_px = {2.3, 0.2}, .b_px = {-0.1, 0.9}};
    stage.surface(std::span(&chart, 1), [](glm::dvec2 p) { return glm::dvec3(p, 0.0); });
    stage.gravity = {{"gravity_m_s2", {0.0, -9.80665, 0.0}}};
    constexpr double volume = 100.0;
    constexpr double aspect = 0.35;
    stage.blood = {{"liquid",
                    {{"viscosity_mpa_s", 1000.0},
                     {"trail_mm", 0.0},
                     {"drop_mm3", volume},
                     {"drop_aspect", aspect},
                     {"max_drops", 256}}},
                   {"wounds",
                    {{{"position_mm", {20, 30, 0}},
                      {"radius_mm", 0.0},
                      {"rate_mm3_s", volume * 120.0 * 1.01},
                      {"stop_s", 1.0 / 120.0}}}}};
    stage.load();
    stage.run(0.0, 0.1, 0.1);
    const auto surface = stage.baked();
    const Image height = stage.read("tissue.blood_height");
    const auto sum_of = [&](auto&& value) {
        double sum = 0.0;
        for (int y = 0; y < stage.size; ++y) {
            for (int x = 0; x < stage.size; ++x) {
                const std::size_t i = surface.index(x, y);
                if (surface.kind[i] == Texel::cell) {
                    sum += height.at(x, y, 0) * surface.metric[i].w * value(surface.position[i]);
                }
            }
        }
        return sum;
    };
    const double whole = sum_of([](const glm::dvec3&) { return 1.0; });
    const glm::dvec2 middle(sum_of([](const glm::dvec3& p) { return p.x; }) / whole,
                            sum_of([](const glm::dvec3& p) { return p.y; }) / whole);
    const double xx = sum_of([&](const glm::dvec3& p) { return std::pow(p.x - middle.x, 2.0); }) / whole;
    const double yy = sum_of([&](const glm::dvec3& p) { return std::pow(p.y - middle.y, 2.0); }) / whole;
    const double xy =
        sum_of([&](const glm::dvec3& p) { return (p.x - middle.x) * (p.y - middle.y); }) / whole;
    // A paraboloid cap of radius R: the second moments are R^2 / 6.
    const double expected = std::pow(2.0 * volume / (std::numbers::pi * aspect), 2.0 / 3.0) / 6.0;
    std::printf("  %.2f mm^3, moments %.3f, %.3f and %.4f mm^2, expected %.3f\n", whole, xx, yy, xy,
                expected);
    EXPECT_NEAR(whole, volume, 0.01 * volume);
    EXPECT_NEAR(xx, expected, 0.02 * expected);
    EXPECT_NEAR(yy, expected, 0.02 * expected);
    EXPECT_NEAR(xy, 0.0, 0.01 * expected);
}

}  // namespace
}  // namespace viscera::test

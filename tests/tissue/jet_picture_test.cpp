#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// How jets of blood are drawn.
namespace viscera::test {
namespace {

using nlohmann::json;

/// Area that white streaks cover [mm^2], on a picture 24 mm high of so many pixels.
double covered_mm2(int pixels, const json& jet) {
    BloodStage stage(32);
    const SurfaceChart chart{
        .high = {40.0, 40.0}, .origin_px = {4.0, 4.0}, .a_px = {0.6, 0.0}, .b_px = {0.0, 0.6}};
    stage.surface(std::span(&chart, 1), [](glm::dvec2 p) { return glm::dvec3(p, 0.0); });
    stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
    stage.blood = {{"liquid", {{"max_drops", 1024}, {"drop_mm3", 0.25}}}};
    // Beside each other, so that few drops lie over each other, and at other places in a wide pixel each.
    for (const double x : {12.1, 16.3, 20.9, 25.4, 29.5}) {
        stage.blood["wounds"].push_back({{"position_mm", {x, 20, 0}},
                                         {"rate_mm3_s", 8.0},
                                         {"kind", "jet"},
                                         {"direction", {0.1, 0, 1}},
                                         {"speed_mm_s", 500.0 + 5.0 * x},
                                         {"pulse_hz", 0.0}});
    }
    json scene = stage.scene();
    // Looks across the surface, which is seen as a line that the jets leave, with room for wide ones below.
    scene["camera"] = {{"kind", "orthographic"},
                       {"eye_mm", {22, -200, 10}},
                       {"target_mm", {22, 0, 10}},
                       {"up", {0, 0, 1}},
                       {"height_mm", 24}};
    scene["resolution"] = {pixels, pixels};
    scene["passes"].push_back({{"name", "organ"},
                               {"effect", "organ.surface"},
                               {"parameters", {{"mesh", stage.mesh}}},
                               {"targets", {{"energy", nullptr}}}});
    scene["passes"].push_back({{"name", "jet"}, {"effect", "tissue.jet"}, {"parameters", jet}});
    scene["targets"]["organ.color"]["format"] = "rgba32f";
    scene["outputs"].push_back("organ.color");
    stage.stage().load(scene);
    stage.stage().renderer().keep({"organ.color"});
    stage.stage().render(0.0);
    stage.stage().render(0.05);
    const Image picture = stage.stage().renderer().read("organ.color");
    double sum = 0.0;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
            EXPECT_TRUE(std::isfinite(picture.at(x, y, 0)));
            sum += picture.at(x, y, 0);
        }
    }
    return sum * 24.0 * 24.0 / (static_cast<double>(pixels) * pixels);
}

TEST(JetPicture, CoversTheSameAtAnyResolution) {
    // Streaks are 0.3 to 0.7 mm wide, 15 pixels to a third of one, and shorter than the way between them.
    const json jet = {{"colour", {1, 1, 1}}, {"exposure_s", 0.001}};
    const double fine = covered_mm2(800, jet);
    ASSERT_GT(fine, 1.0);
    for (const int pixels : {200, 100, 50, 16}) {
        const double coarse = covered_mm2(pixels, jet);
        std::printf("  %3d pixels: %.3f of %.3f mm^2\n", pixels, coarse, fine);
        // Streaks that lie over each other cover less than apart; wide ones do so a little more.
        EXPECT_NEAR(coarse / fine, 1.0, 0.04) << pixels;
    }
}

}  // namespace
}  // namespace viscera::test

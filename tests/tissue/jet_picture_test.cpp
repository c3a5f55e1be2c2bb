#include <array>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/effects/noise_pictures.h"
#include "tests/tissue/blood_stage.h"

// How jets of blood are drawn.
namespace viscera::test {
namespace {

using nlohmann::json;

/// Jets over a level surface, seen from its side, on a picture 24 mm high of so many pixels.
struct JetStage : BloodStage {
    JetStage(int pixels, const json& jet) : BloodStage(32) {
        const SurfaceChart chart{
            .high = {40.0, 40.0}, .origin_px = {4.0, 4.0}, .a_px = {0.6, 0.0}, .b_px = {0.0, 0.6}};
        surface(std::span(&chart, 1), [](glm::dvec2 p) { return glm::dvec3(p, 0.0); });
        gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
        blood = {{"liquid", {{"max_drops", 1024}, {"drop_mm3", 0.25}}}};
        // Beside each other, so that few drops lie over each other, and at other places in a wide pixel each.
        // They close a step before the picture: pieces of a stream that leaves just then do lie over each
        // other.
        for (const double x : {12.1, 16.3, 20.9, 25.4, 29.5}) {
            blood["wounds"].push_back({{"position_mm", {x, 20, 0}},
                                       {"rate_mm3_s", 8.0},
                                       {"kind", "jet"},
                                       {"direction", {0.1, 0, 1}},
                                       {"speed_mm_s", 500.0 + 5.0 * x},
                                       {"pulse_hz", 0.0},
                                       {"stop_s", 0.05}});
        }
        scene_json = scene();
        // Looks across the surface, which is seen as a line that the jets leave, with room for wide ones
        // below.
        look_from({22, -200, 10}, {0, 0, 1});
        scene_json["resolution"] = {pixels, pixels};
        scene_json["passes"].push_back({{"name", "organ"},
                                        {"effect", "organ.surface"},
                                        {"parameters", {{"mesh", mesh}}},
                                        {"targets", {{"energy", nullptr}}}});
        scene_json["passes"].push_back({{"name", "jet"}, {"effect", "tissue.jet"}, {"parameters", jet}});
        scene_json["targets"]["organ.color"]["format"] = "rgba32f";
        scene_json["outputs"].push_back("organ.color");
    }

    void look_from(const std::array<double, 3>& eye_mm, const std::array<double, 3>& up) {
        scene_json["camera"] = {{"kind", "orthographic"},
                                {"eye_mm", eye_mm},
                                {"target_mm", {22, 0, 10}},
                                {"up", up},
                                {"height_mm", 24}};
    }
    [[nodiscard]] json& jet() { return scene_json["passes"].back(); }

    /// What is seen a step after the wounds have closed.
    [[nodiscard]] Image seen() {
        stage().load(scene_json);
        stage().renderer().keep({"organ.color"});
        stage().render(0.0);
        report = stage().render(7.0 / 120.0);
        return stage().renderer().read("organ.color");
    }
    [[nodiscard]] Image seen_without() {
        jet()["enabled"] = false;
        Image picture = seen();
        jet()["enabled"] = true;
        return picture;
    }

    json scene_json;
    FrameReport report;
};

/// Pixels that differ in a channel.
int unlike(const Image& a, const Image& b, int channel) {
    int count = 0;
    for (int y = 0; y < a.height; ++y) {
        for (int x = 0; x < a.width; ++x) {
            count += a.at(x, y, channel) != b.at(x, y, channel) ? 1 : 0;
        }
    }
    return count;
}

/// Area that white streaks cover [mm^2].
double covered_mm2(int pixels, const json& jet) {
    JetStage stage(pixels, jet);
    const Image picture = stage.seen();
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

TEST(JetPicture, LeavesTheAlphaInWhichOrgansKeepTheirBlurriness) {
    JetStage stage(100, {{"colour", {1, 1, 1}}});
    const Image without = stage.seen_without();
    const Image with = stage.seen();
    EXPECT_GT(unlike(with, without, 0), 50);
    EXPECT_EQ(unlike(with, without, 3), 0);
}

TEST(JetPicture, WhatLiesBeforeJetsHidesThem) {
    // From below, through the surface.
    JetStage stage(100, {{"colour", {1, 1, 1}}});
    stage.look_from({22, 20, -200}, {0, 1, 0});
    stage.scene_json["camera"]["target_mm"] = {22, 20, 10};
    const Image without = stage.seen_without();
    EXPECT_EQ(unlike(stage.seen(), without, 0), 0);
    EXPECT_EQ(to_string(pass_of(stage.report, "jet").status), "run");
    stage.jet()["targets"] = {{"depth", nullptr}};
    EXPECT_GT(unlike(stage.seen(), without, 0), 5);
}

TEST(JetPicture, JetsOfSealedWoundsAreNotSeen) {
    const NoisePictures pictures;
    for (const float energy : {0.0F, 0.2F, 1.0F}) {
        JetStage stage(100, {{"colour", {1, 1, 1}}, {"sealed_energy", 0.5}});
        json& passes = stage.scene_json["passes"];
        passes.insert(passes.begin(),
                      NoisePictures::fill("tissue.energy", pictures.noise(1, 4, 4, energy, energy)));
        // Blood that flies comes from wounds that were open.
        for (json& each : passes) {
            if (each["name"] == "blood") {
                each["targets"]["energy"] = nullptr;
            }
        }
        const Image without = stage.seen_without();
        EXPECT_EQ(unlike(stage.seen(), without, 0) > 50, energy < 0.5F) << energy;
    }
}

TEST(JetPicture, WithoutBloodInTheAirThereIsNoPass) {
    JetStage stage(32, json::object());
    (void)stage.seen();
    EXPECT_EQ(to_string(pass_of(stage.report, "jet").status), "run");
    // 630 mm/s up and down again take 130 ms.
    for (const double time : {0.2, 0.3}) {
        stage.report = stage.stage().render(time);
    }
    EXPECT_EQ(to_string(pass_of(stage.report, "jet").status), "idle");
    EXPECT_EQ(pass_of(stage.report, "jet").reason, "no blood is in the air");
}

}  // namespace
}  // namespace viscera::test

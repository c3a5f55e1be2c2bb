#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/io/exr.h"
#include "tests/effects/scenes.h"
#include "tests/tissue/blood_stage.h"

// What lets blood rest, and what wakes it.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr double film_mm = 0.3;

/// A film on a wall, too thin to flow.
void set_still_film(BloodStage& stage) {
    const SurfaceChart chart{
        .high = {60.0, 60.0}, .origin_px = {5.0, 5.0}, .a_px = {0.9, 0.0}, .b_px = {0.0, 0.9}};
    stage.surface(std::span(&chart, 1), [](glm::dvec2 p) { return glm::dvec3(p, 0.0); });
    stage.gravity = {{"gravity_m_s2", {0, -9.80665, 0}}};
    stage.blood["liquid"] = {{"max_drops", 1024}, {"residual_mm", 0.5}};
    stage.spill([](const glm::dvec3& p) { return std::abs(p.x - 30.0) < 20.0 ? film_mm : 0.0; });
}

bool idle(const FrameReport& report) {
    return to_string(pass_of(report, "blood").status) == "idle";
}

/// Frames until the blood rests.
void wait_for_rest(BloodStage& stage, const HostValues* values = nullptr, double longest_s = 10.0) {
    const double until = stage.time_s() + longest_s;
    while (!idle(stage.frame(stage.time_s() + 0.25, values))) {
        ASSERT_LT(stage.time_s(), until) << "the blood never rests";
    }
}

float highest(BloodStage& stage) {
    return std::ranges::max(to_floats(stage.read("tissue.blood_height")));
}

TEST(BloodRest, AWoundWithoutARateLetsItRest) {
    BloodStage stage(64);
    set_still_film(stage);
    HostValues values;
    values.set("tissue.blood_emitters",
               std::array{30.0F, 30.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F});
    wait_for_rest(stage, &values);
}

TEST(BloodRest, AFilmDriesAndThenRests) {
    BloodStage stage(64);
    set_still_film(stage);
    wait_for_rest(stage);
    stage.frame(stage.time_s() + 1.0);
    ASSERT_NEAR(highest(stage), film_mm, 1e-6);
    // It starts to dry while it rests.
    stage.stage().renderer().set_parameter("blood", "/liquid/drying_mm_s", 0.2);
    EXPECT_FALSE(idle(stage.frame(stage.time_s() + 0.25)));
    EXPECT_NEAR(highest(stage), film_mm - 0.2 * 0.25, 1e-4);
    stage.run(stage.time_s(), stage.time_s() + 1.0, 0.25);
    EXPECT_NEAR(highest(stage), film_mm - 0.2 * 1.25, 1e-4);
    wait_for_rest(stage);
    EXPECT_EQ(highest(stage), 0.0F);
    const BloodAccount account = stage.account();
    EXPECT_NEAR(account.gone, film_mm * 40.0 * 60.0, 0.05 * film_mm * 40.0 * 60.0);
}

TEST(BloodRest, WhatTheLiquidIsLikeWakesIt) {
    BloodStage stage(64);
    set_still_film(stage);
    wait_for_rest(stage);
    stage.frame(stage.time_s() + 1.0);
    // A film that may flow now runs down.
    stage.stage().renderer().set_parameter("blood", "/liquid/residual_mm", 0.01);
    EXPECT_FALSE(idle(stage.frame(stage.time_s() + 0.25)));
    stage.run(stage.time_s(), stage.time_s() + 2.0, 0.25);
    EXPECT_GT(stage.account().gone, 20.0);
    // What it looks like does not.
    BloodStage other(64);
    set_still_film(other);
    wait_for_rest(other);
    other.stage().renderer().set_parameter("blood", "/look/bump", 2.0);
    other.frame(other.time_s() + 0.25);
    EXPECT_TRUE(idle(other.frame(other.time_s() + 0.25)));
}

TEST(BloodRest, AToolThatWorksBetweenTwoFramesIsNotMissed) {
    std::vector<std::byte> heights;
    for (const double step : {0.5, 1.0 / 60.0}) {
        BloodStage stage(64);
        stage.blood["tools"] = {{{"kind", "suction"},
                                 {"position_mm", {30, 30, 0}},
                                 {"radius_mm", 12.0},
                                 {"rate", 500.0},
                                 {"start_s", 5.2},
                                 {"stop_s", 5.3}}};
        set_still_film(stage);
        stage.run(0.0, 5.0, step);
        EXPECT_TRUE(idle(stage.frame(5.0)));
        const double before = stage.account().gone;
        stage.run(5.0, 7.0, step);
        std::printf("  every %.3f s: took %.3f mm^3\n", step, stage.account().gone - before);
        EXPECT_GT(stage.account().gone, before + 20.0);
        const Image picture = stage.read("tissue.blood_height");
        EXPECT_TRUE(heights.empty() || heights == picture.data);
        heights = picture.data;
    }
}

/// Wounds in tissue that is burnt but for a stripe at the right.
class SealedWounds : public testing::Test {
  protected:
    static constexpr std::array<float, 12> ooze{20.0F, 40.0F, 0.0F, 1.5F, 60.0F, 0.0F,
                                                0.0F,  0.0F,  1.0F, 0.0F, 0.0F,  0.0F};
    static constexpr std::array<float, 12> jet{30.0F, 40.0F, 0.0F, 0.5F,   200.0F, 1.0F,
                                               0.0F,  0.3F,  1.0F, 300.0F, 0.0F,   0.0F};
    static constexpr std::array<float, 12> open{54.0F, 40.0F, 0.0F, 1.0F, 60.0F, 0.0F,
                                                0.0F,  0.0F,  1.0F, 0.0F, 0.0F,  0.0F};

    std::string energy_file(BloodStage& stage, const char* name, float burnt) {
        Image image = make_image(64, 64, PixelFormat::rgba32f);
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                for (int c = 0; c < 4; ++c) {
                    image.set(x, y, c, x < 48 ? burnt : 0.0F);
                }
            }
        }
        const io::ExrPart part{.name = "energy", .image = image};
        io::write_exr(stage.folder / name, std::span(&part, 1));
        return (stage.folder / name).string();
    }
    void set(BloodStage& stage) {
        set_still_film(stage);
        stage.more.push_back(
            pass("energy", "picture.image",
                 {{"file", energy_file(stage, "burnt.exr", 1.0F)}, {"fit", "stretch"}, {"monochrome", false}},
                 {{"image", "tissue.energy"}}));
        stage.load();
    }
    static HostValues wounds(std::initializer_list<std::array<float, 12>> of) {
        std::vector<float> all;
        for (const auto& wound : of) {
            all.insert(all.end(), wound.begin(), wound.end());
        }
        HostValues values;
        values.set("tissue.blood_emitters", all);
        return values;
    }
};

TEST_F(SealedWounds, LetBloodRest) {
    BloodStage stage(64);
    set(stage);
    const HostValues sealed = wounds({ooze, jet});
    wait_for_rest(stage, &sealed);
    const double lay = stage.account().film;
    EXPECT_TRUE(idle(stage.frame(stage.time_s() + 0.25, &sealed)));
    EXPECT_TRUE(idle(stage.frame(stage.time_s() + 3.0, &sealed))) << "it goes on resting";
    EXPECT_EQ(stage.account().film, lay);
    EXPECT_EQ(highest(stage), static_cast<float>(film_mm));

    // One that is not sealed bleeds.
    const HostValues another = wounds({ooze, jet, open});
    EXPECT_FALSE(idle(stage.frame(stage.time_s() + 0.25, &another)));
    stage.run(stage.time_s(), stage.time_s() + 1.0, 0.25, &another);
    EXPECT_GT(stage.account().film + stage.account().drops, lay + 30.0);
    for (int i = 0; i < 12; ++i) {
        EXPECT_FALSE(idle(stage.frame(stage.time_s() + 0.25, &another))) << "for as long as it does";
    }
}

TEST_F(SealedWounds, BleedAgainWhereEnergyIsTakenAway) {
    BloodStage stage(64);
    set(stage);
    const HostValues sealed = wounds({ooze});
    wait_for_rest(stage, &sealed);
    const double lay = stage.account().film;
    stage.stage().renderer().set_parameter("energy", "/file", energy_file(stage, "fresh.exr", 0.0F));
    EXPECT_FALSE(idle(stage.frame(stage.time_s() + 0.25, &sealed)));
    stage.run(stage.time_s(), stage.time_s() + 1.0, 0.25, &sealed);
    EXPECT_GT(stage.account().film + stage.account().drops, lay + 30.0);
}

TEST_F(SealedWounds, LeaveNoTraceOfWhenTheyWereFoundOut) {
    // At other frame rates the answer comes at another time.
    std::vector<std::vector<std::byte>> heights;
    for (const double step : {0.25, 1.0 / 24.0}) {
        BloodStage stage(64);
        set(stage);
        const HostValues sealed = wounds({ooze, jet});
        stage.run(0.0, 6.0, step, &sealed);
        EXPECT_TRUE(idle(stage.frame(6.0, &sealed)));
        const HostValues another = wounds({ooze, jet, open});
        stage.run(6.0, 8.0, step, &another);
        heights.push_back(stage.read("tissue.blood_height").data);
    }
    EXPECT_EQ(heights[0], heights[1]);
}

TEST_F(SealedWounds, WithoutEnergyTheSameWoundsBleedOn) {
    BloodStage stage(64);
    set_still_film(stage);
    const HostValues same = wounds({ooze, jet});
    stage.run(0.0, 5.0, 0.25, &same);
    for (int i = 0; i < 8; ++i) {
        EXPECT_FALSE(idle(stage.frame(stage.time_s() + 0.25, &same)));
    }
}

}  // namespace
}  // namespace viscera::test

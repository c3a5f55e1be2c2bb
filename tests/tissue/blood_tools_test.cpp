#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// How much suction and rinsing take, and a ring with as many drops as the bench has.
namespace viscera::test {
namespace {

using nlohmann::json;

void set_wall(BloodStage& stage, const glm::dvec3& gravity_m_s2) {
    const SurfaceChart chart{
        .high = {60.0, 60.0}, .origin_px = {5.0, 5.0}, .a_px = {0.9, 0.0}, .b_px = {0.0, 0.9}};
    stage.surface(std::span(&chart, 1), [](glm::dvec2 p) { return glm::dvec3(p, 0.0); });
    stage.gravity = {{"gravity_m_s2", {gravity_m_s2.x, gravity_m_s2.y, gravity_m_s2.z}}};
}

json tool(const char* kind, const glm::dvec3& at, double radius_mm, double rate, double start_s) {
    return {{"kind", kind},
            {"position_mm", {at.x, at.y, at.z}},
            {"radius_mm", radius_mm},
            {"rate", rate},
            {"start_s", start_s}};
}

TEST(BloodTools, RinsingTakesItsShareOfDrops) {
    // One drop that leaves nothing behind, far within the tool's reach.
    for (const double rate : {0.5, 2.0, 30.0}) {
        BloodStage stage(64);
        set_wall(stage, {0.0, -9.80665, 0.0});
        stage.blood = {
            {"liquid",
             {{"viscosity_mpa_s", 40.0}, {"trail_mm", 0.0}, {"drop_life_s", 600.0}, {"max_drops", 256}}},
            {"wounds",
             {{{"position_mm", {30, 50, 0}},
               {"radius_mm", 0.0},
               {"rate_mm3_s", 0.5 * 120.0 * 1.01},
               {"stop_s", 1.0 / 120.0}}}},
            {"tools", json::array({tool("rinse", {30, 50, 0}, 200.0, rate, 0.5)})}};
        stage.load();
        stage.run(0.0, 0.5, 0.1);
        EXPECT_NEAR(stage.account().drops, 0.5, 1e-6);
        stage.run(0.5, 1.0, 0.1);
        const BloodAccount account = stage.account();
        const double expected = 0.5 * std::exp(-0.5 * rate);
        std::printf("  %.1f/s: %.5f mm^3 left, expected %.5f\n", rate, account.drops, expected);
        // A drop below a fiftieth of a new one ends.
        EXPECT_NEAR(account.drops, expected > 0.02 * 0.5 ? expected : 0.0, 1e-4);
        EXPECT_NEAR(account.gone, 0.5 - account.drops, 1e-5);
        EXPECT_NEAR(account.film, 0.0, 1e-6);
    }
}

TEST(BloodTools, SuctionTakesItsRateOfAThickFilm) {
    BloodStage stage(64);
    set_wall(stage, {0.0, 0.0, -9.80665});
    stage.blood["liquid"] = {{"max_drops", 256}};
    stage.gravity["open_edges"] = false;
    stage.blood["tools"] = json::array({tool("suction", {30, 30, 0}, 8.0, 60.0, 0.5)});
    stage.spill([](const glm::dvec3&) { return 2.0; });
    stage.run(0.0, 0.5, 0.1);
    EXPECT_EQ(stage.account().gone, 0.0);
    stage.run(0.5, 1.5, 0.1);
    std::printf("  took %.2f mm^3 of 60 in a second\n", stage.account().gone);
    EXPECT_NEAR(stage.account().gone, 60.0, 1.0);
}

TEST(BloodTools, SuctionTakesNoMoreThanItsRateOfDrops) {
    for (const double rate : {5.0, 20.0}) {
        BloodStage stage(64);
        set_wall(stage, {0.0, -9.80665, 0.0});
        stage.blood = {
            {"liquid",
             {{"viscosity_mpa_s", 200.0},
              {"trail_mm", 0.0},
              {"drop_mm3", 0.1},
              {"drop_life_s", 600.0},
              {"max_drops", 1024}}},
            {"wounds",
             {{{"position_mm", {30, 30, 0}}, {"radius_mm", 10.0}, {"rate_mm3_s", 96.0}, {"stop_s", 0.5}}}},
            {"tools", json::array({tool("suction", {30, 30, 0}, 12.0, rate, 0.5)})}};
        stage.load();
        stage.run(0.0, 0.5, 0.1);
        const BloodAccount before = stage.account();
        stage.run(0.5, 1.0, 0.1);
        const BloodAccount after = stage.account();
        std::printf("  %.2f mm^3 of %.2f in drops went in half a second at %.0f mm^3/s\n",
                    after.gone - before.gone, before.drops, rate);
        EXPECT_GT(after.gone - before.gone, 0.05 * 0.5 * rate);
        EXPECT_LT(after.gone - before.gone, 0.5 * rate);
        EXPECT_NEAR(after.kept() / after.given, 1.0, 1e-5);
    }
}

TEST(BloodTools, AHundredThousandDropsLiveAndKeepTheirVolume) {
    constexpr int capacity = 102400;
    constexpr double drop_mm3 = 0.001;
    BloodStage stage(64);
    set_wall(stage, {0.0, -9.80665, 0.0});
    stage.blood = {
        {"liquid",
         {{"max_drops", capacity}, {"drop_mm3", drop_mm3}, {"trail_mm", 0.0}, {"drop_life_s", 600.0}}}};
    for (int i = 0; i < 256; ++i) {
        // Eight drops in each step.
        stage.blood["wounds"].push_back({{"position_mm", {6.0 + 3.0 * (i % 16), 10.0 + 3.0 * (i / 16), 0.0}},
                                         {"radius_mm", 2.0},
                                         {"rate_mm3_s", 8.0001 * drop_mm3 * 120.0}});
    }
    stage.load();
    BloodAccount account;
    for (const int steps : {0, 49, 56}) {
        account = account_of([&] {
            stage.frame(steps / 120.0);
            return stage.read("tissue.blood_account");
        }());
        std::printf("  after %d steps: %.0f drops given, %.0f live\n", steps, account.given / drop_mm3,
                    account.drops / drop_mm3);
        EXPECT_NEAR(account.given, 256 * 8 * steps * drop_mm3, 1e-3 * capacity * drop_mm3);
        EXPECT_NEAR(account.kept(), account.given, 1e-5 * capacity * drop_mm3);
        if (steps == 49) {
            EXPECT_GT(account.drops, 0.99 * 100352 * drop_mm3) << "all of them live";
        }
    }
    // More than there is room for has turned the oldest into film.
    EXPECT_LE(account.drops, capacity * drop_mm3 * (1.0 + 1e-4));
    EXPECT_GT(account.film, 10.0 * drop_mm3);
}

}  // namespace
}  // namespace viscera::test

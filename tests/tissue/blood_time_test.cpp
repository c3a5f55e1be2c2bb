#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/effects/noise_pictures.h"
#include "tests/tissue/blood_stage.h"

// Blood in time: frame rates, rest, sealing, jets, and input that makes no sense.
namespace viscera::test {
namespace {

using nlohmann::json;

glm::dvec3 slope(glm::dvec2 at) {
    return {at.x, at.y, 0.02 * (at.y - 30.0) * (at.y - 30.0) + 0.4 * std::sin(0.4 * at.x + 0.2 * at.y)};
}

void set_slope(BloodStage& stage) {
    const double scale = 0.9 * stage.size / 64.0;
    const SurfaceChart chart{.high = {60.0, 60.0},
                             .origin_px = {5.0, 5.0},
                             .a_px = {scale, 0.0},
                             .b_px = {0.0, scale},
                             .cells = {20, 20}};
    stage.surface(std::span(&chart, 1), slope);
    stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
}

json wound(double x, double y, double rate) {
    const glm::dvec3 p = slope({x, y});
    return {{"position_mm", {p.x, p.y, p.z}}, {"rate_mm3_s", rate}};
}

TEST(BloodTime, NoFrameRateChangesTheBlood) {
    std::map<std::string, std::vector<std::byte>> first;
    for (const double step : {1.0 / 15.0, 1.0 / 240.0, 0.2}) {
        BloodStage stage(64);
        set_slope(stage);
        stage.blood = {{"liquid", {{"steps_per_s", 240.0}, {"max_drops", 1024}}},
                       {"wounds", json::array({wound(20, 55, 80.0), wound(42, 50, 25.0)})}};
        stage.load();
        stage.run(0.0, 1.0, step);
        for (const char* target : {"tissue.blood_height", "tissue.blood_color", "tissue.blood_normal"}) {
            const Image image = stage.read(target);
            const auto [found, added] = first.emplace(target, image.data);
            EXPECT_EQ(found->second, image.data) << target << " at 1 / " << 1.0 / step;
            EXPECT_EQ(added, step == 1.0 / 15.0);
        }
    }
}

/// Blood keeps its state beside the targets; who shows one late frame has to render those before it all the
/// same.
TEST(BloodTime, SaysThatFramesBuildOnEachOther) {
    BloodStage stage(64);
    set_slope(stage);
    stage.load();
    EXPECT_TRUE(stage.stage().renderer().keeps_state());
    json scene = stage.scene();
    for (json& pass : scene["passes"]) {
        pass["enabled"] = pass["effect"] != "tissue.blood" && pass["effect"] != "tissue.blood_account";
    }
    scene["outputs"] = {"tissue.gravity"};
    stage.stage().load(scene);
    EXPECT_FALSE(stage.stage().renderer().keeps_state());
}

/// A film that only faces know to be drawn by a relief would stop at seams.
TEST(BloodTime, AnotherMeshOrNoReliefAsItsFlowHasIsSaid) {
    BloodStage stage(64);
    set_slope(stage);
    stage.blood = {{"wounds", json::array({wound(20, 55, 80.0)})}};
    stage.relief([](const glm::dvec3& p) { return 0.1 * std::sin(p.x); });
    const json scene = stage.scene();
    const auto faults_with = [&](const char* part, const char* key, const json& value) {
        json changed = scene;
        for (json& pass : changed["passes"]) {
            if (pass["effect"] == "tissue.blood") {
                pass[part][key] = value;
            }
        }
        stage.stage().load(changed);
        stage.frame(0.0);
        stage.frame(0.1);
        return stage.stage().renderer().log().faults();
    };
    const auto none = faults_with("parameters", "state", "same");
    for (const char* fault : {"tissue.no_relief", "tissue.no_flow", "tissue.other_mesh"}) {
        EXPECT_FALSE(none.contains(fault)) << fault;
    }
    const auto faults = faults_with("targets", "relief", nullptr);
    EXPECT_TRUE(faults.contains("tissue.no_relief"));
    EXPECT_FALSE(faults.contains("tissue.no_flow"));
    EXPECT_FALSE(faults.contains("tissue.other_mesh"));
    json mesh = scene["passes"][0]["parameters"]["mesh"];
    mesh["atlas"] = "generated";
    EXPECT_TRUE(faults_with("parameters", "mesh", mesh).contains("tissue.other_mesh"));
}

TEST(BloodTime, RestsWhenNothingMoves) {
    BloodStage stage(64);
    set_slope(stage);
    // Thick blood comes to rest as a film of the residual thickness, or in the trough.
    json bleeding = wound(20, 52, 60.0);
    bleeding["start_s"] = 0.5;
    bleeding["stop_s"] = 0.7;
    stage.blood = {{"liquid", {{"max_drops", 1024}, {"residual_mm", 0.15}, {"drop_life_s", 2.0}}},
                   {"wounds", json::array({bleeding})}};
    stage.load();
    const auto report = [&](double time) { return pass_of(stage.frame(time), "blood"); };
    EXPECT_EQ(to_string(report(0.0).status), "idle");
    EXPECT_EQ(report(0.2).reason, "there is no blood");
    EXPECT_EQ(to_string(report(0.6).status), "run");
    double rested = 0.0;
    for (double time = 0.8; time < 120.0 && rested == 0.0; time += 0.25) {
        rested = to_string(report(time).status) == "idle" ? time : 0.0;
    }
    ASSERT_GT(rested, 0.0) << "the blood never rests";
    std::printf("  rests after %.2f s\n", rested);
    const Image height = stage.read("tissue.blood_height");
    EXPECT_EQ(to_string(report(rested + 7.0).status), "idle");
    EXPECT_EQ(stage.read("tissue.blood_height").data, height.data);
    EXPECT_GT(stage.account().film, 10.0);

    // Suction wakes it.
    HostValues values;
    const glm::dvec3 p = slope({20.0, 40.0});
    values.set("tissue.suction", std::array{static_cast<float>(p.x), static_cast<float>(p.y),
                                            static_cast<float>(p.z), 25.0F, 2000.0F});
    EXPECT_EQ(to_string(pass_of(stage.frame(rested + 7.2, &values), "blood").status), "run");
    stage.run(rested + 7.2, rested + 9.0, 0.2, &values);
    const BloodAccount account = stage.account();
    EXPECT_GT(account.gone, 0.9 * account.given);
    EXPECT_NEAR(account.kept() / account.given, 1.0, 1e-3);
}

TEST(BloodTime, RestingChangesNoPicture) {
    // The same with a tool that does nothing that can be seen, for whose sake no tile rests.
    std::array<Image, 2> pictures;
    for (std::size_t i = 0; i < 2; ++i) {
        BloodStage stage(64);
        set_slope(stage);
        json bleeding = wound(20, 52, 60.0);
        bleeding["stop_s"] = 0.2;
        stage.blood = {{"liquid", {{"max_drops", 1024}, {"residual_mm", 0.3}, {"drop_life_s", 2.0}}},
                       {"wounds", json::array({bleeding})}};
        if (i == 1) {
            stage.blood["tools"] = json::array(
                {{{"kind", "suction"}, {"position_mm", {1000, 0, 0}}, {"radius_mm", 1.0}, {"rate", 1.0}}});
        }
        stage.load();
        const auto status = pass_of(stage.run(0.0, 60.0, 0.5), "blood").status;
        EXPECT_EQ(to_string(status), i == 0 ? "idle" : "run");
        pictures[i] = stage.read("tissue.blood_height");
    }
    double worst = 0.0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            worst = std::max(
                worst, std::abs(static_cast<double>(pictures[0].at(x, y, 0)) - pictures[1].at(x, y, 0)));
        }
    }
    std::printf("  rest changes heights by %.1e mm at most\n", worst);
    // What stands would creep by less than 5e-4 mm/s, and its speed would fall as t^-3/2 from then on: after
    // some 20 s by 0.02 mm in all time to come.
    EXPECT_LT(worst, 0.02);
}

TEST(BloodTime, ThePictureDrawnInPartsIsTheWholeOne) {
    // Drops that come, run over a seam and end, and suction that leaves blocks without blood.
    BloodStage stage(96);
    const std::array<SurfaceChart, 2> charts{SurfaceChart{.high = {30.0, 60.0}, .origin_px = {5.0, 5.0}},
                                             SurfaceChart{.low = {30.0, 0.0},
                                                          .high = {60.0, 60.0},
                                                          .origin_px = {15.3, 5.0},
                                                          .a_px = {1.0, 0.0},
                                                          .b_px = {0.0, 1.0}}};
    stage.surface(charts, slope);
    stage.gravity = {{"gravity_m_s2", {4.0, 0, -9.0}}};
    const glm::dvec3 tip = slope({20.0, 50.0});
    stage.blood = {{"liquid", {{"max_drops", 1024}, {"drop_life_s", 0.3}}},
                   {"wounds", json::array({wound(20, 52, 60.0), wound(28, 20, 40.0)})},
                   {"tools",
                    {{{"kind", "suction"},
                      {"position_mm", {tip.x, tip.y, tip.z}},
                      {"radius_mm", 12.0},
                      {"rate", 5000.0},
                      {"start_s", 1.5}}}}};
    stage.blood["wounds"][0]["stop_s"] = 1.2;
    stage.load();
    for (const double until : {0.6, 1.4, 2.5}) {
        stage.run(stage.time_s(), until, 1.0 / 40.0);
        std::map<std::string, std::vector<float>> parts;
        const std::array targets{"tissue.blood_height", "tissue.blood_color", "tissue.blood_normal"};
        for (const char* target : targets) {
            parts[target] = to_floats(stage.read(target));
        }
        // The same blood in targets that hold nothing.
        stage.load();
        EXPECT_EQ(to_string(pass_of(stage.frame(until), "blood").status), "run");
        for (const char* target : targets) {
            // As numbers: 0 and -0 are the same.
            const std::vector<float> whole = to_floats(stage.read(target));
            std::size_t unlike = 0;
            for (std::size_t i = 0; i < whole.size(); ++i) {
                unlike += whole[i] == parts[target][i] ? 0U : 1U;
            }
            EXPECT_EQ(unlike, 0U) << target << " at " << until << " s";
        }
    }
}

TEST(BloodTime, TwoPassesShowTheSameBlood) {
    BloodStage stage(64);
    set_slope(stage);
    stage.blood = {{"liquid", {{"max_drops", 1024}, {"drop_life_s", 0.3}}},
                   {"wounds", json::array({wound(20, 52, 60.0)})}};
    stage.blood["wounds"][0]["stop_s"] = 0.5;
    // Both draw in parts, from what each has drawn itself.
    json scene = stage.scene();
    json second = *std::ranges::find(scene["passes"], "blood", [](const json& p) { return p["name"]; });
    second["name"] = "second";
    for (const auto& [port, target] :
         {std::pair("height", "second.height"), std::pair("colour", "second.colour")}) {
        second["targets"][port] = target;
        scene["outputs"].push_back(target);
    }
    scene["targets"]["second.height"] = {{"format", "r32f"}};
    scene["passes"].push_back(second);
    stage.stage().load(scene);
    for (const double until : {0.3, 0.6, 2.0}) {
        stage.run(stage.time_s(), until, 1.0 / 40.0);
        EXPECT_EQ(to_floats(stage.read("second.height")), to_floats(stage.read("tissue.blood_height")));
        EXPECT_EQ(to_floats(stage.read("second.colour")), to_floats(stage.read("tissue.blood_color")));
    }
}

TEST(BloodTime, CoagulatedTissueDoesNotBleed) {
    const NoisePictures pictures;
    for (const float energy : {0.0F, 0.375F, 1.0F}) {
        BloodStage stage(64);
        set_slope(stage);
        stage.more.push_back(NoisePictures::fill("tissue.energy", pictures.noise(1, 4, 4, energy, energy)));
        stage.blood = {{"liquid", {{"max_drops", 1024}, {"drop_mm3", 0.25}}},
                       {"wounds", json::array({wound(20, 52, 60.0)})}};
        stage.load();
        stage.run(0.0, 1.0, 0.1);
        const BloodAccount account = stage.account();
        const double share = energy == 0.0F ? 1.0 : energy == 1.0F ? 0.0 : 0.5;
        EXPECT_NEAR(account.given, 60.0 * share, 0.5) << energy;
        EXPECT_NEAR(account.kept(), account.given, 1e-3 * 60.0);
    }
}

TEST(BloodTime, JetsFlyAndComeDownAsDrops) {
    BloodStage stage(64);
    const SurfaceChart chart{
        .high = {60.0, 60.0}, .origin_px = {5.0, 5.0}, .a_px = {0.9, 0.0}, .b_px = {0.0, 0.9}};
    stage.surface(std::span(&chart, 1), [](glm::dvec2 p) { return glm::dvec3(p, 0.0); });
    stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
    // At 45 degrees and 500 mm/s it flies v^2 / g = 25.5 mm in 72 ms.
    stage.blood = {{"liquid", {{"max_drops", 1024}, {"drop_mm3", 0.25}}},
                   {"wounds",
                    {{{"position_mm", {15, 30, 0}},
                      {"rate_mm3_s", 200.0},
                      {"kind", "jet"},
                      {"direction", {1, 0, 1}},
                      {"speed_mm_s", 500.0},
                      {"pulse_hz", 0.0}}}}};
    stage.load();
    stage.run(0.0, 0.05, 0.05);
    EXPECT_GT(stage.account().drops, 8.0);
    EXPECT_EQ(stage.account().film, 0.0);
    stage.run(0.05, 1.0, 0.05);
    const auto surface = stage.baked();
    const Image height = stage.read("tissue.blood_height");
    double mass = 0.0;
    double place = 0.0;
    for (std::size_t i = 0; i < surface.kind.size(); ++i) {
        const double h = height.at(static_cast<int>(i % 64), static_cast<int>(i / 64), 0);
        mass += h;
        place += h * surface.position[i].x;
    }
    std::printf("  comes down at %.2f mm, expected %.2f mm\n", place / mass, 15.0 + 25.5);
    EXPECT_NEAR(place / mass, 15.0 + 25.5, 1.5);
    const BloodAccount account = stage.account();
    EXPECT_NEAR(account.given, 200.0, 2.0);
    EXPECT_NEAR(account.kept() / account.given, 1.0, 1e-5);
}

TEST(BloodStress, NothingMakesItLoseItsHead) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    struct Case {
        const char* name;
        double scale;
        glm::dvec3 gravity;
        double rate;
        double gap;
    };
    for (const Case& c :
         {Case{"no gravity", 1.0, {0, 0, 0}, 100.0, 0.1}, Case{"a huge rate", 1.0, {0, 0, -9.8}, 1e7, 0.1},
          Case{"a tiny organ", 1e-4, {0, 0, -9.8}, 1e-6, 0.1},
          Case{"a huge organ", 200.0, {0, 0, -9.8}, 1e5, 0.1},
          Case{"strong gravity", 1.0, {0, 0, -1000.0}, 100.0, 0.1},
          Case{"long gaps", 1.0, {0, 0, -9.8}, 100.0, 1e6}}) {
        BloodStage stage(64);
        const SurfaceChart chart{.high = {60.0, 60.0},
                                 .origin_px = {5.0, 5.0},
                                 .a_px = {0.9, 0.0},
                                 .b_px = {0.0, 0.9},
                                 .cells = {8, 8}};
        stage.surface(std::span(&chart, 1), [&](glm::dvec2 at) { return c.scale * slope(at); });
        stage.gravity = {{"gravity_m_s2", {c.gravity.x, c.gravity.y, c.gravity.z}}};
        json bleeding = wound(30, 40, c.rate);
        for (json& x : bleeding["position_mm"]) {
            x = x.get<double>() * c.scale;
        }
        bleeding["radius_mm"] = c.scale;
        stage.blood = {{"liquid", {{"max_drops", 1024}}}, {"wounds", json::array({bleeding})}};
        if (c.scale < 1.0) {
            stage.blood["liquid"]["drop_mm3"] = 1e-9;
        }
        stage.load();
        HostValues values;
        values.set("tissue.blood_emitters",
                   std::array{nan,  0.0F, 0.0F, 1.0F, 10.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F,  //
                              0.0F, 0.0F, 0.0F, 1.0F, -5.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 7.0F});
        values.set("tissue.rinse", std::array{nan, 0.0F, 0.0F, 1.0F, 1.0F});
        for (int i = 0; i < 6; ++i) {
            stage.frame(c.gap * i, &values);
            stage.frame(c.gap * i, &values);  // no time passes
        }
        for (const char* target : {"tissue.blood_height", "tissue.blood_color", "tissue.blood_normal"}) {
            SCOPED_TRACE(std::string(c.name) + ", " + target);
            expect_finite(stage.read(target));
        }
        const BloodAccount account = stage.account();
        EXPECT_GT(account.given, 0.0) << c.name;
        EXPECT_NEAR(account.kept() / account.given, 1.0, 1e-3) << c.name;
        const auto faults = stage.stage().renderer().log().faults();
        EXPECT_TRUE(faults.contains("tissue.wound_not_finite")) << c.name;
        EXPECT_TRUE(faults.contains("tissue.tool_not_finite"));
        EXPECT_TRUE(faults.contains("tissue.host_records"));
    }
}

TEST(BloodStress, TenThousandWoundsBleed) {
    // Into a ring that holds them all, and into one that does not.
    for (const int max_drops : {16384, 256}) {
        BloodStage stage(64);
        set_slope(stage);
        stage.blood = {{"liquid", {{"max_drops", max_drops}, {"drop_mm3", 0.01}}}};
        stage.load();
        std::vector<float> emitters;
        for (int i = 0; i < 10000; ++i) {
            const glm::dvec3 p = slope({2.0 + 0.56 * (i % 100), 2.0 + 0.56 * (i / 100)});
            for (const double v :
                 {p.x, p.y, p.z, 0.2, 0.6, i % 50 == 0 ? 1.0 : 0.0, 0.0, 0.0, 1.0, 300.0, 0.0, 0.0}) {
                emitters.push_back(static_cast<float>(v));
            }
        }
        HostValues values;
        values.set("tissue.blood_emitters", emitters);
        for (int i = 0; i <= 8; ++i) {
            stage.frame(0.025 * i, &values);
        }
        for (const char* target : {"tissue.blood_height", "tissue.blood_color", "tissue.blood_normal"}) {
            SCOPED_TRACE(target);
            expect_finite(stage.read(target));
        }
        const BloodAccount account = stage.account();
        // In whole drops of 1/100 mm^3.
        std::printf("  %5d drops: given %.1f = film %.1f + drops %.1f + gone %.1f mm^3\n", max_drops,
                    account.given, account.film, account.drops, account.gone);
        EXPECT_NEAR(account.given, 10000 * 0.6 * 0.2, 10000 * 0.01);
        EXPECT_NEAR(account.kept() / account.given, 1.0, 1e-5);
        EXPECT_TRUE(stage.stage().complaints().empty()) << stage.stage().complaints().front();
    }
}

TEST(BloodStress, AMovedSurfaceKeepsItsBlood) {
    BloodStage stage(64);
    set_slope(stage);
    stage.mesh["host_positions"] = "organ";
    stage.blood = {{"liquid", {{"max_drops", 1024}}}, {"wounds", json::array({wound(20, 52, 60.0)})}};
    stage.blood["wounds"][0]["stop_s"] = 0.5;
    stage.load();
    HostValues values;
    std::vector<float> places;
    for (int i = 1; i <= 20; ++i) {
        places.clear();
        for (int y = 0; y <= 20; ++y) {
            for (int x = 0; x <= 20; ++x) {
                const glm::dvec3 p = (1.0 + 0.02 * i) * slope({3.0 * x, 3.0 * y});
                places.insert(places.end(),
                              {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
            }
        }
        values.set("organ", places);
        stage.frame(0.1 * i, &values);
    }
    const BloodAccount account = stage.account();
    EXPECT_GT(account.given, 20.0);
    EXPECT_NEAR(account.kept() / account.given, 1.0, 1e-5);
    EXPECT_TRUE(stage.stage().complaints().empty()) << stage.stage().complaints().front();
}

}  // namespace
}  // namespace viscera::test

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "effects/tissue/blood_sources.h"
#include "tests/tissue/blood_stage.h"

// What tissue.blood says of a scene or a host that asks for what it cannot do.
namespace viscera::test {
namespace {

using nlohmann::json;

void set_plane(BloodStage& stage) {
    const SurfaceChart chart{
        .high = {60.0, 60.0}, .origin_px = {5.0, 5.0}, .a_px = {0.9, 0.0}, .b_px = {0.0, 0.9}};
    stage.surface(std::span(&chart, 1), [](glm::dvec2 p) { return glm::dvec3(p, 0.0); });
    stage.gravity = {{"gravity_m_s2", {0, 0, -9.80665}}};
    stage.blood = {{"liquid", {{"max_drops", 1024}}}};
}

json wound(double rate) {
    return {{"position_mm", {30, 30, 0}}, {"rate_mm3_s", rate}};
}

std::uint64_t count_of(BloodStage& stage, const char* key) {
    const auto faults = stage.stage().renderer().log().faults();
    const auto found = faults.find(key);
    return found == faults.end() ? 0 : found->second;
}

void expect_sound(BloodStage& stage) {
    expect_finite(stage);
    const BloodAccount account = stage.account();
    EXPECT_NEAR(account.kept(), account.given, 1e-3 * account.given + 1e-6);
}

TEST(BloodFaults, AGravityOfAnotherBakeIsSaid) {
    BloodStage stage(64);
    set_plane(stage);
    stage.blood["wounds"] = json::array({wound(20.0)});
    json scene = stage.scene();
    json mesh = stage.mesh;
    const SurfaceChart chart{.high = {50.0, 50.0}, .origin_px = {5.0, 5.0}};
    mesh["file"] = stage.folder
                       .write("other.obj", surface_obj(std::span(&chart, 1), 64,
                                                       [](glm::dvec2 p) { return glm::dvec3(p, 0.0); }))
                       .string();
    json targets;
    for (const char* port : {"position", "normal", "metric", "seam"}) {
        targets[port] = std::string("other.") + port;
    }
    scene["passes"].insert(scene["passes"].begin(),
                           pass("other", "tissue.bake", {{"mesh", mesh}, {"size", 64}}, targets));
    for (json& each : scene["passes"]) {
        if (each["name"] == "gravity") {
            each["targets"] = targets;
        }
    }
    stage.stage().load(scene);
    stage.frame(0.0);
    EXPECT_EQ(count_of(stage, "tissue.no_flow"), 1U);
}

TEST(BloodFaults, AScenesWoundsAndToolsHaveLimits) {
    const auto where_of = [](const char* what, std::size_t count) {
        BloodStage stage(32);
        set_plane(stage);
        stage.blood[what] = json::array();
        for (std::size_t i = 0; i < count; ++i) {
            stage.blood[what].push_back({{"position_mm", {0, 0, 0}}});
        }
        try {
            stage.load();
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(where_of("tools", tissue::most_tools), "");
    EXPECT_NE(where_of("tools", tissue::most_tools + 1).find("more than 16 tools"), std::string::npos);
    EXPECT_NE(where_of("wounds", tissue::most_wounds + 1).find("more than 65536 wounds"), std::string::npos);
}

TEST(BloodFaults, AHostsWoundsAndToolsBeyondTheirLimitAreLeftOut) {
    BloodStage stage(32);
    set_plane(stage);
    stage.blood["wounds"] = json::array({wound(20.0)});
    stage.load();
    HostValues values;
    std::vector<float> wounds;
    for (std::size_t i = 0; i < tissue::most_wounds + 2; ++i) {
        wounds.insert(wounds.end(), {10, 10, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0});
    }
    std::vector<float> tools;
    for (std::size_t i = 0; i < tissue::most_tools + 3; ++i) {
        tools.insert(tools.end(), {10, 10, 0, 2, 1});
    }
    values.set("tissue.blood_emitters", wounds);
    values.set("tissue.suction", tools);
    stage.frame(0.0, &values);
    EXPECT_EQ(count_of(stage, "tissue.too_many_wounds"), 3U) << "with the scene's";
    EXPECT_EQ(count_of(stage, "tissue.too_many_tools"), 3U);
    stage.frame(0.1, &values);
    expect_sound(stage);
}

TEST(BloodFaults, AToolTooSmallForFloatsDoesNothing) {
    BloodStage stage(32);
    set_plane(stage);
    stage.blood["wounds"] = json::array({wound(60.0)});
    stage.load();
    HostValues values;
    stage.frame(0.0, &values);
    for (const float radius : {1e-25F, 1e-30F, 1e-7F, 0.0F}) {
        values.set("tissue.suction", std::array{30.0F, 30.0F, 0.0F, radius, 1e38F});
        stage.frame(stage.time_s() + 0.1, &values);
        expect_sound(stage);
    }
    EXPECT_EQ(count_of(stage, "tissue.tool_not_finite"), 4U);
    // Small ones and large ones that work.
    for (const float radius : {2e-6F, 1e30F}) {
        values.set("tissue.suction", std::array{30.0F, 30.0F, 0.0F, radius, 3e38F});
        stage.frame(stage.time_s() + 0.1, &values);
        expect_sound(stage);
    }
    EXPECT_EQ(count_of(stage, "tissue.tool_not_finite"), 4U);
}

TEST(BloodFaults, AJetWithoutADirectionWellsUp) {
    BloodStage stage(32);
    set_plane(stage);
    json jet = wound(60.0);
    jet["kind"] = "jet";
    jet["direction"] = {0, 0, 0};
    stage.blood["wounds"] = json::array({jet});
    stage.load();
    stage.run(0.0, 0.5, 0.1);
    EXPECT_GT(count_of(stage, "tissue.jet_no_direction"), 0U);
    EXPECT_NEAR(stage.account().given, 30.0, 1.0);
    expect_sound(stage);
}

TEST(BloodFaults, AWoundOnASurfaceWithoutAnyIsSaid) {
    BloodStage stage(32);
    set_plane(stage);
    stage.mesh["host_positions"] = "organ";
    stage.blood["wounds"] = json::array({wound(60.0), wound(20.0)});
    stage.load();
    HostValues values;
    values.set("organ", std::vector<float>(4 * 3, 1.0F));
    stage.frame(0.0, &values);
    stage.frame(0.1, &values);
    stage.frame(0.2, &values);
    EXPECT_EQ(count_of(stage, "tissue.wound_no_place"), 2U);
    EXPECT_EQ(stage.account().given, 0.0);
    expect_sound(stage);
}

TEST(BloodFaults, MoreInTheAirThanThereIsRoomForIsSaid) {
    BloodStage stage(32);
    set_plane(stage);
    for (int i = 0; i < 40; ++i) {
        stage.blood["wounds"].push_back({{"position_mm", {20 + 0.5 * i, 30, 0}},
                                         {"rate_mm3_s", 120.0},
                                         {"kind", "jet"},
                                         {"speed_mm_s", 2000.0}});
    }
    stage.load();
    stage.run(0.0, 0.3, 0.1);
    EXPECT_GT(count_of(stage, "tissue.too_much_in_the_air"), 0U);
    expect_sound(stage);
}

TEST(BloodFaults, BloodThatNoPassMakesIsSaidAndEmpty) {
    BloodStage stage(32);
    set_plane(stage);
    stage.blood["wounds"] = json::array({wound(60.0)});
    json scene = stage.scene();
    for (json& each : scene["passes"]) {
        if (each["name"] == "account") {
            each["parameters"]["state"] = "blod";
        }
    }
    const auto fault = [&] { return count_of(stage, "tissue.no_blood_of_name"); };
    stage.stage().load(scene);
    stage.frame(0.0);
    const FrameReport& report = stage.frame(0.1);
    EXPECT_EQ(to_string(pass_of(report, "account").status), "idle");
    EXPECT_GT(fault(), 0U);
    for (const float value : to_floats(stage.read("tissue.blood_account"))) {
        ASSERT_EQ(value, 0.0F);
    }
    // A pass that draws its jets says the same.
    stage.load();
    const std::uint64_t before = fault();
    stage.frame(0.2);
    EXPECT_EQ(fault(), before);
    scene = stage.scene();
    scene["passes"].push_back(pass("organ", "organ.surface", {{"mesh", stage.mesh}}, {{"energy", nullptr}}));
    scene["passes"].push_back(pass("jet", "tissue.jet", {{"state", "blod"}}));
    scene["outputs"].push_back("organ.color");
    stage.stage().load(scene);
    stage.frame(0.3);
    EXPECT_EQ(fault(), before + 1);
}

}  // namespace
}  // namespace viscera::test

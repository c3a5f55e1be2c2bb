#include <gtest/gtest.h>

#include "tests/effects/noise_pictures.h"
#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"

// What a scene does not need is not done, says so with its reason, and the picture is the same as with it.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int skip_side = 96;

json smoke_parameters() {
    return {{"emitters", json::array({{{"base_mm", {0, 0, -20}},
                                       {"tip_mm", {18, 3, -12}},
                                       {"edge_mm", {20, 4, -10}},
                                       {"start_s", 0.0},
                                       {"stop_s", 1e6}}})},
            {"views", json::array({{{"angle_deg", 90}, {"image", "../sprites/smoke_side.exr"}}})}};
}

/// Background, vessels in one pass, summary, smoke and composite.
json chain(const json& parameters = tube_parameters(), const json& smoke = smoke_parameters()) {
    return scene_of(
        tube_camera(),
        {pass("background", "picture.image", {{"file", "../images/thorax.exr"}}),
         pass("vessels", "contrast.geometry", parameters), pass("summarize", "contrast.summarize"),
         pass("reflux", "contrast.reflux", smoke), pass("composite", "contrast.composite")},
        {"final"}, skip_side, skip_side);
}

json& pass_in(json& scene, const std::string& name) {
    return *std::ranges::find_if(scene["passes"], [&](const json& p) { return p["name"] == name; });
}

void erase_pass(json& scene, const std::string& name) {
    json& passes = scene["passes"];
    passes.erase(std::ranges::find_if(passes, [&](const json& p) { return p["name"] == name; }));
}

class Skip : public testing::Test {
  protected:
    void TearDown() override {
        if (!complaints_expected_) {
            EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front();
        }
    }
    /// Expects a pass's status and reason in the last frame.
    void expect(std::string_view name, PassStatus status, std::string_view reason) {
        const PassReport pass = pass_of(report_, name);
        EXPECT_EQ(to_string(pass.status), to_string(status)) << name << ": " << pass.reason;
        EXPECT_EQ(pass.reason, reason) << name;
    }
    [[nodiscard]] PassStatus status(std::string_view name) const { return pass_of(report_, name).status; }
    [[nodiscard]] bool draws(std::string_view name) const {
        return status(name) == PassStatus::run || status(name) == PassStatus::reduced;
    }
    void render(double time_s, const HostValues* values = nullptr) {
        report_ = stage_.render(time_s, values);
    }
    Image picture(std::string_view target = "final") { return stage_.renderer().read(target); }

    /// The same frame where nothing has been drawn before.
    static Image cold(const json& scene, double time_s, std::string_view target = "final",
                      const HostValues* values = nullptr) {
        Stage other;
        other.load(scene);
        return other.shot(target, time_s, values);
    }
    void expect_cold(const json& scene, double time_s, const HostValues* values = nullptr) {
        const Image now = picture();
        EXPECT_EQ(now.data, cold(scene, time_s, "final", values).data);
        stage_.make_current();
    }

    Stage stage_;
    FrameReport report_;
    bool complaints_expected_ = false;
};

/// A short bolus in a slow flow: the vessels are still full when the injection has long ended.
json late_parameters() {
    json parameters = tube_parameters();
    parameters["vessel"]["flow"]["injection_speed_mm_s"] = 50;
    parameters["bolus"] = {{"start_s", 0.2}, {"duration_s", 0.4}, {"rise_s", 0.1}, {"washout_s", 0.05}};
    return parameters;
}

TEST_F(Skip, WithoutInjectionTheSummaryIsMain) {
    const json scene = chain(late_parameters());
    stage_.load(scene);
    stage_.renderer().keep({"contrast.main", "contrast.summary"});
    render(1.3);
    expect("summarize", PassStatus::idle, "no injection: the summary is contrast.main itself");
    EXPECT_NE(stage_.renderer().texture("contrast.main"), 0U);
    EXPECT_EQ(stage_.renderer().texture("contrast.summary"), stage_.renderer().texture("contrast.main"));
    const Image skipped = picture();

    // A cloud of nothing, drawn by another, forces the pass to run.
    const NoisePictures pictures;
    json forced = chain(late_parameters());
    pass_in(forced, "vessels")["effect"] = "contrast.main";
    json& passes = forced["passes"];
    passes.insert(passes.begin() + 2,
                  NoisePictures::fill("contrast.cloud", pictures.noise(1, 4, 4, 0.0F, 0.0F), false));
    stage_.load(forced);
    render(1.3);
    EXPECT_TRUE(draws("summarize"));
    EXPECT_EQ(picture().data, skipped.data);
}

TEST_F(Skip, CloudAndDistanceRestWithoutInjection) {
    json scene = chain(late_parameters());
    pass_in(scene, "vessels")["effect"] = "contrast.main";
    for (const char* name : {"cloud", "distance"}) {
        scene["passes"].insert(scene["passes"].begin() + 2,
                               pass(name, std::string("contrast.") + name, late_parameters()));
    }
    scene["outputs"].push_back("contrast.distance");  // the picture itself does not need it
    stage_.load(scene);
    render(1.3);
    expect("cloud", PassStatus::idle, "no injection at this time");
    expect("distance", PassStatus::idle, "no injection at this time");
    EXPECT_TRUE(draws("vessels"));
    expect_cold(chain(late_parameters()), 1.3);
    render(0.5);
    EXPECT_TRUE(draws("cloud"));
    EXPECT_TRUE(draws("distance"));
    EXPECT_TRUE(draws("summarize"));
}

TEST_F(Skip, NoSmokeWithoutAnEmitterInTheView) {
    json nothing = chain();  // the picture that all of them must give
    erase_pass(nothing, "reflux");
    const Image without = cold(nothing, 0.7);
    stage_.make_current();
    const std::vector<std::pair<json, std::string>> cases{
        {json::array(), "no emitter active"},
        {json::array({{{"base_mm", {0, 0, -20}},
                       {"tip_mm", {18, 3, -12}},
                       {"edge_mm", {20, 4, -10}},
                       {"start_s", 2}}}),
         "no emitter active"},
        {json::array({{{"base_mm", {900, 0, -20}}, {"tip_mm", {918, 3, -12}}, {"edge_mm", {920, 4, -10}}}}),
         "no emitter in the view"}};
    for (const auto& [emitters, reason] : cases) {
        json smoke = smoke_parameters();
        smoke["emitters"] = emitters;
        stage_.load(chain(tube_parameters(), smoke));
        render(0.7);
        expect("reflux", PassStatus::idle, reason);
        EXPECT_EQ(picture().data, without.data);
    }
    // With smoke the picture is another; smoke of no strength is none.
    stage_.load(chain());
    render(0.7);
    EXPECT_TRUE(draws("reflux"));
    EXPECT_NE(picture().data, without.data);
    json faint = smoke_parameters();
    faint["emitters"][0]["strength"] = 0;
    stage_.load(chain(tube_parameters(), faint));
    render(0.7);
    expect("reflux", PassStatus::idle, "no emitter active");
    EXPECT_EQ(picture().data, without.data);
}

TEST_F(Skip, SmokeOfNoBrightnessTouchesNoPixel) {
    json smoke = smoke_parameters();
    // Its base lies beside the vessel.
    smoke["emitters"][0]["base_mm"] = {24, 0, -20};
    smoke["emitters"][0]["tip_mm"] = {8, 3, -12};
    smoke["emitters"][0]["edge_mm"] = {8, 5, -10};
    json scene = chain(tube_parameters(), smoke);
    scene["targets"]["contrast.reflux"] = {{"clear", {0.25}}};  // what any smoke would change under GL_MAX
    stage_.load(scene);
    const Image reflux = stage_.shot("contrast.reflux", 0.7);
    const std::vector<float> values = to_floats(reflux);
    EXPECT_TRUE(std::ranges::all_of(values, [](float v) { return v == 0.25F; }));
}

TEST_F(Skip, NothingButTheBackgroundBeforeAndAfterTheBolus) {
    json background = chain();
    background["passes"] = {background["passes"][0], background["passes"][4]};
    for (const auto& [time_s, reason] : {std::pair{0.1, "no contrast yet: the injection has not begun"},
                                         {9.0, "no contrast in the vessels at this time"}}) {
        stage_.load(chain());
        render(time_s);
        expect("vessels", PassStatus::idle, reason);
        EXPECT_EQ(status("summarize"), PassStatus::idle);
        expect("reflux", PassStatus::idle, "no contrast that could leave the vessels");
        expect_cold(background, time_s);
    }
}

TEST_F(Skip, AVesselOutOfViewIsNotDrawn) {
    json scene = chain();
    scene["camera"]["isocentre_mm"] = {0, 0, 900};
    stage_.load(scene);
    render(0.7);
    expect("vessels", PassStatus::idle, "the vessel lies outside the view");
    json background = scene;
    background["passes"] = {scene["passes"][0], scene["passes"][4]};
    expect_cold(background, 0.7);
}

TEST_F(Skip, WhatNoOutputNeedsIsCulled) {
    json scene = chain();
    scene["passes"].push_back(pass("inspection", "contrast.distance_view"));
    json& off = pass_in(scene, "reflux");
    off["enabled"] = false;
    stage_.load(scene);
    render(0.7);
    EXPECT_EQ(status("inspection"), PassStatus::culled);
    EXPECT_NE(pass_of(report_, "inspection").reason.find("no output needs it"), std::string::npos);
    EXPECT_EQ(status("reflux"), PassStatus::culled);
    EXPECT_EQ(pass_of(report_, "reflux").reason, "disabled");
    json without = chain();
    erase_pass(without, "reflux");
    expect_cold(without, 0.7);
}

TEST_F(Skip, TheCloudsOwnPassIsDrawnWhereTheCloudIs) {
    json parameters = tube_parameters();
    parameters["cloud"]["radius_mm"] = 6;
    json scene = chain(parameters);
    pass_in(scene, "vessels")["effect"] = "contrast.main";
    scene["passes"].insert(scene["passes"].begin() + 2, pass("cloud", "contrast.cloud", parameters));
    stage_.load(scene);
    render(0.7);
    expect("cloud", PassStatus::reduced, "only where the cloud can be seen");
    expect_cold(chain(parameters), 0.7);
    pass_in(scene, "cloud")["parameters"]["cloud"]["centre_mm"] = {0, 0, 400};
    stage_.load(scene);
    render(0.7);
    expect("cloud", PassStatus::idle, "the cloud lies outside the view");
    parameters["cloud"]["brightness"] = 0;
    expect_cold(chain(parameters), 0.7);
}

/// A later pass draws the vessels, so that of one pass's three pictures nobody reads the first.
TEST_F(Skip, OfSeveralPicturesThoseThatAreReadAreDrawn) {
    json scene = chain();
    json again = pass_in(scene, "vessels");
    again["name"] = "again";
    again["effect"] = "contrast.main";
    scene["passes"].insert(scene["passes"].begin() + 2, again);
    stage_.load(scene);
    render(0.7);
    EXPECT_TRUE(draws("vessels"));
    EXPECT_TRUE(draws("summarize"));
    expect_cold(chain(), 0.7);
}

TEST_F(Skip, OnlyThePartThatTheVesselCanCoverIsDrawn) {
    json scene = chain();
    scene["camera"]["detector_height_mm"] = 400;
    stage_.load(scene);
    stage_.renderer().keep({"contrast.main"});
    render(0.7);
    expect("vessels", PassStatus::reduced, "only where the vessel can be seen");
    // That nothing is cut off, the references prove, which know no region: geometry_accuracy_test.cpp.
    const Image main = picture("contrast.main");
    int lit = 0;
    for (int y = 0; y < skip_side; ++y) {
        for (int x = 0; x < skip_side; ++x) {
            lit += main.at(x, y, 0) > 0.0F ? 1 : 0;
        }
    }
    EXPECT_GT(lit, 50);
}

TEST_F(Skip, AStaticFrameRunsNoPass) {
    const json scene = chain();
    stage_.load(scene);
    render(0.7);
    EXPECT_TRUE(draws("vessels"));
    render(0.7);
    for (const PassReport& pass : report_.passes) {
        EXPECT_EQ(to_string(pass.status), "cached") << pass.name;
        EXPECT_EQ(pass.reason, "inputs, parameters and camera unchanged") << pass.name;
    }
    expect_cold(scene, 0.7);
}

TEST_F(Skip, ThePlateauIsOnePictureThoughTimePasses) {
    json parameters = tube_parameters();
    parameters["bolus"]["duration_s"] = 4;
    const json scene = chain(parameters);
    stage_.load(scene);
    render(2.0);
    EXPECT_TRUE(draws("vessels"));
    render(2.5);
    for (const PassReport& pass : report_.passes) {
        EXPECT_EQ(to_string(pass.status), "cached") << pass.name;
    }
    expect_cold(scene, 2.5);
    render(4.6);  // the wash-out has begun
    EXPECT_TRUE(draws("vessels"));
    expect_cold(scene, 4.6);
}

TEST_F(Skip, ACameraMoveRedrawsTheVesselsAndKeepsTheBackground) {
    json scene = chain();
    scene["camera"]["orbit_deg_per_s"] = 0;
    stage_.load(scene);
    render(0.7);
    Frame frame = stage_.renderer().still(0.7);
    CameraParams moved = stage_.renderer().scene().camera;
    moved.primary_deg += 4.0;
    frame.eyes[0] = make_view(moved, frame.aspect());
    report_ = stage_.renderer().render(frame);
    EXPECT_EQ(status("background"), PassStatus::cached);
    for (const char* name : {"vessels", "summarize", "reflux", "composite"}) {
        EXPECT_TRUE(draws(name)) << name;
    }
    scene["camera"]["primary_deg"] = moved.primary_deg;
    expect_cold(scene, 0.7);
}

TEST_F(Skip, AParameterRedrawsItsPassAndWhatFollows) {
    json scene = chain();
    stage_.load(scene);
    render(0.7);
    stage_.renderer().set_parameter("composite", "/darkest", 0.3);
    render(0.7);
    EXPECT_TRUE(draws("composite"));
    for (const char* name : {"background", "vessels", "summarize", "reflux"}) {
        EXPECT_EQ(to_string(status(name)), "cached") << name;
    }
    pass_in(scene, "composite")["parameters"]["darkest"] = 0.3;
    expect_cold(scene, 0.7);

    stage_.renderer().set_parameter("vessels", "/cloud/radius_mm", 12);
    render(0.7);
    EXPECT_EQ(status("background"), PassStatus::cached);
    for (const char* name : {"vessels", "summarize", "reflux", "composite"}) {
        EXPECT_TRUE(draws(name)) << name;
    }
    pass_in(scene, "vessels")["parameters"]["cloud"]["radius_mm"] = 12;
    expect_cold(scene, 0.7);
}

TEST_F(Skip, HostValuesRedrawTheVesselsThatTheyChange) {
    json parameters = tube_parameters();
    parameters["vessel"] = {{"mesh", "../meshes/tube.glb"}, {"density", "per_vertex"}};
    const json scene = chain(parameters);
    stage_.load(scene);
    render(0.7);
    HostValues values;
    values.set("DENSITY", std::vector<float>(1428, 0.1F));
    render(0.7, &values);
    EXPECT_EQ(status("background"), PassStatus::cached);
    EXPECT_TRUE(draws("vessels"));
    expect_cold(scene, 0.7, &values);
    values.set("another", std::vector<float>(3, 1.0F));
    render(0.7, &values);
    for (const PassReport& pass : report_.passes) {
        EXPECT_EQ(to_string(pass.status), "cached") << pass.name;
    }
    values.set("DENSITY", std::vector<float>(1428, 0.15F));
    render(0.7, &values);
    EXPECT_TRUE(draws("vessels"));
    expect_cold(scene, 0.7, &values);
    // Without the host's values, the mesh's own come back.
    render(0.7);
    EXPECT_TRUE(draws("vessels"));
    expect_cold(scene, 0.7);
}

TEST_F(Skip, AResizeRedrawsAll) {
    json scene = chain();
    stage_.load(scene);
    render(0.7);
    Frame frame = stage_.renderer().still(0.7);
    frame.width = 120;
    frame.eyes[0] = make_view(stage_.renderer().scene().camera, frame.aspect());
    report_ = stage_.renderer().render(frame);
    for (const PassReport& pass : report_.passes) {
        EXPECT_TRUE(draws(pass.name)) << pass.name;
    }
    scene["resolution"] = {120, skip_side};
    EXPECT_EQ(picture().width, 120);
    expect_cold(scene, 0.7);
    report_ = stage_.renderer().render(frame);
    for (const PassReport& pass : report_.passes) {
        EXPECT_EQ(to_string(pass.status), "cached") << pass.name;
    }
}

TEST_F(Skip, AssetsThatNoDrawingPassNeedsAreNeverOpened) {
    json scene = chain();
    json missing = tube_parameters();
    missing["vessel"]["mesh"] = "nowhere/vessel.glb";
    missing["vessel"]["centreline"] = "nowhere/centreline.json";
    // Culled, disabled, and idle because the injection has not begun.
    scene["passes"].push_back(pass("culled", "contrast.main", missing, {{"main", "nobody.reads"}}));
    scene["passes"].push_back(
        pass("disabled", "picture.image", {{"file", "nowhere/image.exr"}}, {{"image", "off"}}));
    scene["passes"].back()["enabled"] = false;
    json late = missing;
    late["bolus"]["start_s"] = 100;
    scene["passes"].insert(scene["passes"].begin() + 4,
                           pass("later", "contrast.main", late, {{"main", "contrast.capillary"}}));
    // No emitter smokes yet.
    json smoke = smoke_parameters();
    smoke["views"][0]["image"] = "nowhere/smoke.exr";
    smoke["front"] = "nowhere/front.exr";
    smoke["emitters"][0]["start_s"] = 100;
    pass_in(scene, "reflux")["parameters"] = smoke;
    stage_.load(scene);
    render(0.7);
    EXPECT_EQ(status("culled"), PassStatus::culled);
    EXPECT_EQ(status("disabled"), PassStatus::culled);
    EXPECT_EQ(status("later"), PassStatus::idle);
    EXPECT_EQ(status("reflux"), PassStatus::idle);
    json without = chain();
    erase_pass(without, "reflux");
    expect_cold(without, 0.7);
    // The paths really lead nowhere.
    EXPECT_THROW(render(101.0), Error);
    complaints_expected_ = true;
}

}  // namespace
}  // namespace viscera::test

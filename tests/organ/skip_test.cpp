#include <array>
#include <utility>

#include <gtest/gtest.h>

#include "tests/organ/organ_stage.h"

// What an organ need not do, reported and without a trace in the picture.
namespace viscera::test {
namespace {

using nlohmann::json;

class OrganSkip : public testing::Test {
  protected:
    PassReport report() const { return pass_of(s.report(), "organ"); }
    /// A pass that is idle for good, so that what it writes is empty.
    static json resting(const std::string& target, const json& mesh) {
        return pass("rest-" + target, "organ.surface",
                    {{"mesh", {{"file", mesh}, {"placement", {{"move_mm", {0, 0, 9000}}}}}}},
                    {{"colour", target}, {"depth", target + ".depth"}});
    }
    OrganStage s{64, 64};
};

TEST_F(OrganSkip, OutsideTheViewNothingIsDrawnAndNoPictureRead) {
    s.parameters["diffuse_map"] = "nowhere/diffuse.png";
    s.parameters["normal_map"] = {{"map", "nowhere/normal.png"}};
    s.parameters["mesh"]["placement"] = {{"move_mm", {900, 0, 0}}};
    const Image image = s.render();
    EXPECT_EQ(report().status, PassStatus::idle);
    EXPECT_EQ(report().reason, "the organ lies outside the view");
    for (int c = 0; c < 4; ++c) {
        EXPECT_EQ(image.at(20, 20, c), c == 3 ? 0.5F : 0.0F);
    }
    // In the view the paths do lead nowhere.
    s.parameters["mesh"]["placement"] = {{"move_mm", {0, 0, 0}}};
    EXPECT_THROW((void)s.render(), Error);
}

TEST_F(OrganSkip, AnUntouchedOrganIsThePlainOne) {
    const Image plain = s.render();
    EXPECT_EQ(report().status, PassStatus::reduced);
    EXPECT_EQ(report().reason, "only where the organ can be seen");
    // Tissue effects that have nothing to draw leave their targets empty.
    json scene = s.scene();
    const json file = s.parameters["mesh"]["file"];
    json passes = json::array();
    for (const char* target :
         {"tissue.energy", "tissue.blood_color", "tissue.blood_normal", "tissue.blood_height"}) {
        passes.push_back(resting(target, file));
    }
    passes.push_back(scene["passes"].back());
    scene["passes"] = passes;
    s.stage().load(scene);
    const FrameReport report = s.stage().render(0.0);
    EXPECT_EQ(pass_of(report, "rest-tissue.energy").status, PassStatus::idle);
    EXPECT_EQ(pass_of(report, "organ").reason, "only where the organ can be seen");
    EXPECT_EQ(s.stage().renderer().read("organ.color").data, plain.data);
}

TEST_F(OrganSkip, EnergyOfZeroAndClearBloodChangeNoBit) {
    const Image plain = s.render();
    s.target("tissue.energy", 8, [](double, double, int) { return 0.0F; });
    s.target("tissue.blood_color", 8, [](double, double, int c) { return c == 3 ? 0.0F : 1.0F; });
    s.target("tissue.blood_normal", 8, [](double, double, int c) { return c == 2 ? 1.0F : 0.0F; });
    const Image image = s.render();
    EXPECT_EQ(report().reason, "only where the organ can be seen, with energy, blood, blood relief");
    EXPECT_EQ(image.data, plain.data);
    // As published, untouched tissue is burnt.
    s.parameters["coagulation"] = {{"burn_curve", "thesis"}};
    EXPECT_NE(s.render().data, plain.data);
}

TEST_F(OrganSkip, AHintThatDoesNotShowIsCompiledOut) {
    const Image plain = s.render();
    s.parameters["hint"] = {{"map", s.picture_file("hint.exr", 8, [](double, double, int) { return 1.0F; })}};
    EXPECT_EQ(s.render(0.0).data, plain.data);
    EXPECT_EQ(report().reason, "only where the organ can be seen");
    EXPECT_NE(s.render(0.75).data, plain.data);
    EXPECT_EQ(report().reason, "only where the organ can be seen, with hint");
}

TEST_F(OrganSkip, WithoutSpotsThereIsNoHematoma) {
    const Image plain = s.render();
    s.parameters["hematoma"] = {{"host_spots", "bruises"}};
    EXPECT_EQ(s.render().data, plain.data);
    EXPECT_EQ(report().reason, "only where the organ can be seen");
    HostValues values;
    values.set("bruises", std::array{0.0F, -8.0F, 0.0F, 20.0F});
    EXPECT_NE(s.render(0.0, &values).data, plain.data);
    EXPECT_EQ(report().reason, "only where the organ can be seen, with hematoma");
}

TEST_F(OrganSkip, AStillOrganIsCached) {
    s.parameters["hematoma"] = {{"host_spots", "bruises"}};
    HostValues values;
    values.set("bruises", std::array{0.0F, -8.0F, 0.0F, 20.0F});
    const Image first = s.render(0.0, &values);
    EXPECT_EQ(pass_of(s.stage().render(0.5, &values), "organ").status, PassStatus::cached);
    EXPECT_EQ(s.stage().renderer().read("organ.color").data, first.data);
    values.set("bruises", std::array{0.0F, -8.0F, 0.0F, 10.0F});
    EXPECT_EQ(pass_of(s.stage().render(0.5, &values), "organ").status, PassStatus::reduced);
    EXPECT_NE(s.stage().renderer().read("organ.color").data, first.data);
}

TEST_F(OrganSkip, AHintThatComesAndGoesIsDrawnAnewAndAStandingOneIsNot) {
    s.parameters["hint"] = {{"map", s.picture_file("hint.exr", 8, [](double, double, int) { return 1.0F; })}};
    (void)s.render(0.3);
    EXPECT_EQ(pass_of(s.stage().render(0.4), "organ").status, PassStatus::reduced);
    s.parameters["hint"]["period_s"] = 0;
    (void)s.render(0.3);
    EXPECT_EQ(pass_of(s.stage().render(0.4), "organ").status, PassStatus::cached);
}

TEST_F(OrganSkip, AClearMembraneIsNotDrawnWhereNothingShinesOnIt) {
    const Image plain = s.render();
    const auto through = [&](double opacity, double specular, double glow_mm, PassReport& report) {
        json scene = s.scene();
        json membrane = s.parameters;
        membrane["mesh"]["placement"] = {{"move_mm", {0, -3, 0}}};
        membrane["blending"] = "blended";
        membrane["into_picture"] = true;
        membrane["opacity"] = opacity;
        membrane["shading"]["specular"] = specular;
        membrane["lights"][0]["glow_mm"] = glow_mm;
        scene["passes"].push_back(pass("membrane", "organ.surface", membrane));
        s.stage().load(scene);
        report = pass_of(s.stage().render(0.0), "membrane");
        return s.stage().renderer().read("organ.color");
    };
    PassReport report;
    EXPECT_EQ(through(0.0, 0.0, 0.0, report).data, plain.data);
    EXPECT_EQ(report.status, PassStatus::idle);
    EXPECT_EQ(report.reason, "the membrane is clear, and nothing shines on it");
    // Highlights and overexposure lie on top of it, however clear it is.
    const std::array<std::pair<double, double>, 2> shining{{{0.3, 0.0}, {0.0, 200.0}}};
    for (const auto& [specular, glow_mm] : shining) {
        const Image clear = through(0.0, specular, glow_mm, report);
        EXPECT_NE(report.status, PassStatus::idle);
        EXPECT_NE(clear.data, plain.data);
        const Image nearly = through(1e-9, specular, glow_mm, report);
        const std::vector<float> a = to_floats(clear);
        const std::vector<float> b = to_floats(nearly);
        for (std::size_t i = 0; i < a.size(); ++i) {
            ASSERT_NEAR(a[i], b[i], 1e-6F);
        }
    }
}

TEST_F(OrganSkip, WhatIsUncoveredMayBeClearedBeforeOrAfter) {
    s.parameters["focus"] = {{"near_mm", 60}, {"focus_mm", 92}, {"far_mm", 125}, {"clamp_far", 0.7}};
    json scene = s.scene();
    scene["targets"]["organ.color"] = {{"format", "rgba16f"}};
    json second = s.parameters;
    second["into_picture"] = true;
    second["mesh"]["placement"] = {{"move_mm", {-30, -12, 0}}};
    scene["passes"].push_back(pass("second", "organ.surface", second));
    std::vector<std::vector<Image>> shots;
    for (const BackgroundFill fill : {BackgroundFill::before, BackgroundFill::after}) {
        Stage stage(Backend::osmesa, {}, ComputeUse::automatic, fill);
        std::vector<Image>& images = shots.emplace_back();
        stage.load(scene);
        stage.renderer().keep({"organ.color"});
        // To the left, to the right, out of the picture and back: what was there before must be gone.
        for (const double shift : {0.0, 0.35, -0.6, 5.0, 0.1}) {
            Frame frame = stage.renderer().still(0.0);
            frame.eyes[0].projection[2][0] += shift;
            stage.renderer().render(frame);
            images.push_back(stage.renderer().read("organ.color"));
        }
        EXPECT_TRUE(stage.complaints().empty());
    }
    for (std::size_t i = 0; i < shots[0].size(); ++i) {
        EXPECT_EQ(shots[0][i].data, shots[1][i].data) << "frame " << i;
    }
    EXPECT_NE(shots[0][0].data, shots[0][1].data);
    s.stage().make_current();
}

TEST_F(OrganSkip, AnOrganThatBecomesAMembraneIsNotClearedAfterwards) {
    std::vector<Image> shots;
    for (const bool changes : {false, true}) {
        Stage stage(Backend::osmesa, {}, ComputeUse::automatic, BackgroundFill::after);
        s.parameters["blending"] = changes ? "opaque" : "blended";
        s.parameters["opacity"] = 0.5;
        stage.load(s.scene());
        stage.renderer().keep({"organ.color"});
        stage.render(0.0);
        if (changes) {
            stage.renderer().set_parameter("organ", "/blending", "blended");
            stage.render(0.0);
        }
        shots.push_back(stage.renderer().read("organ.color"));
    }
    EXPECT_EQ(shots[0].data, shots[1].data);
    s.stage().make_current();
}

TEST_F(OrganSkip, OrgansOfOnePictureHideEachOther) {
    // A red one and a green one that stands nearer on the left half, in either order of passes.
    json red = s.parameters;
    red["colour"] = {1, 0, 0};
    json green = s.parameters;
    green["colour"] = {0, 1, 0};
    green["mesh"]["placement"] = {{"move_mm", {-30, -12, 0}}};
    std::vector<Image> images;
    for (const bool red_first : {true, false}) {
        json first = red_first ? red : green;
        json second = red_first ? green : red;
        second["into_picture"] = true;
        json scene = s.scene();
        scene["passes"] = {pass("first", "organ.surface", first), pass("second", "organ.surface", second)};
        s.stage().load(scene);
        s.stage().render(0.0);
        images.push_back(s.stage().renderer().read("organ.color"));
    }
    EXPECT_EQ(images[0].data, images[1].data);
    EXPECT_GT(images[0].at(10, 32, 1), 3.0F * images[0].at(10, 32, 0));
    EXPECT_GT(images[0].at(54, 32, 0), 3.0F * images[0].at(54, 32, 1));
}

}  // namespace
}  // namespace viscera::test

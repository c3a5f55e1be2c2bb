#include <algorithm>

#include "engine/core/hash.h"
#include "tests/runtime/runtime_test.h"

namespace viscera::test {
namespace {

/// A recipe that does not look at the view.
class SharedRecipe final : public Effect {
  public:
    explicit SharedRecipe(Recipe recipe) : inner_(std::move(recipe)) {}
    void visit(ParamVisitor& v) override { inner_.visit(v); }
    std::vector<Port> ports() const override { return inner_.ports(); }
    bool uses_view() const override { return false; }
    std::span<const ProgramDesc> programs() const override { return inner_.programs(); }
    Work prepare(Prepare& prepare) override { return inner_.prepare(prepare); }
    void draw(const Pass& pass) override { inner_.draw(pass); }

  private:
    RecipeEffect inner_;
};

/// Where the eye is [mm], the one number of a view that these tests tell eyes by.
float place_of(const Frame& frame) {
    return static_cast<float>(frame.eye().eye_mm.x);
}

Work prepare_by_view(Prepare& prepare, double) {
    return Work::all(Hash().add(prepare.parameters_key()).add(prepare.frame().eye().eye_mm.x).value());
}

void draw_view(const Pass& pass, double value) {
    pass.use(fill).set("u_value", place_of(pass.frame()) + static_cast<float>(value));
    pass.draw_fullscreen();
}

class TwoEyes : public RuntimeTest {
  protected:
    TwoEyes() {
        add_shared("shared",
                   {.ports = {write_port("out", "base")}, .prepare = prepare_cached, .draw = draw_fill});
        add("view", {.ports = {write_port("out", "x")}, .prepare = prepare_by_view, .draw = draw_view});
        add_shared("sum", {.ports = {read_port("in", "x"), write_port("out", "y", 7.0F)},
                           .prepare = prepare_cached,
                           .draw = draw_add("in")});
        add("half_idle", {.ports = {write_port("out", "x", 4.0F)},
                          .prepare =
                              [](Prepare& prepare, double) {
                                  return prepare.frame().eye().eye_mm.x < 0.0
                                             ? Work::idle("nothing to the left")
                                             : Work::all(1);
                              },
                          .draw = draw_view});
    }
    void add_shared(const std::string& name, Recipe recipe) {
        add_effect(name, [recipe] { return std::make_unique<SharedRecipe>(recipe); });
    }
    [[nodiscard]] static Frame frame_of(double left, double right) {
        Frame frame{.width = 8, .height = 4};
        frame.eyes[0].eye_mm.x = left;
        frame.eyes[1].eye_mm.x = right;
        frame.eye_count = 2;
        return frame;
    }
    [[nodiscard]] static std::size_t drawn(const FrameReport& report) {
        return static_cast<std::size_t>(std::ranges::count_if(report.passes, [](const PassReport& pass) {
            return pass.status == PassStatus::run || pass.status == PassStatus::reduced;
        }));
    }
};

TEST_P(TwoEyes, WhatDependsOnTheEyeIsDrawnForEachAndTheRestOnce) {
    renderer().set_scene(make_scene({{"shared", 3.0}, {"view", 0.5}, {"sum", 1.0}}, {"y", "base"}));
    const FrameReport& report = renderer().render(frame_of(-2.0, 5.0));
    ASSERT_EQ(report.passes.size(), 5U);
    EXPECT_EQ(report.passes[0].name, "p0");
    EXPECT_EQ(report.passes[0].eye, -1);
    EXPECT_EQ(report.passes[1].name, "p1.left");
    EXPECT_EQ(report.passes[2].name, "p1.right");
    EXPECT_EQ(report.passes[2].eye, 1);
    EXPECT_EQ(drawn(report), 5U);
    EXPECT_EQ(value_of("y.left"), -0.5F);
    EXPECT_EQ(value_of("y.right"), 6.5F);
    EXPECT_EQ(value_of("base"), 3.0F);
    EXPECT_EQ(to_json(report)["passes"][2]["eye"], "right");
    EXPECT_TRUE(to_json(report)["passes"][0]["eye"].is_null());
}

TEST_P(TwoEyes, EachEyeIsCachedAndDrawnAloneWhenItAloneMoves) {
    renderer().set_scene(make_scene({{"shared", 3.0}, {"view", 0.5}, {"sum", 1.0}}, {"y", "base"}));
    renderer().render(frame_of(-2.0, 5.0));
    EXPECT_EQ(drawn(renderer().render(frame_of(-2.0, 5.0))), 0U);
    const FrameReport& report = renderer().render(frame_of(-2.0, 9.0));
    EXPECT_EQ(status(report, 1), PassStatus::cached);
    EXPECT_EQ(status(report, 2), PassStatus::run);
    EXPECT_EQ(drawn(report), 2U);
    EXPECT_EQ(value_of("y.left"), -0.5F);
    EXPECT_EQ(value_of("y.right"), 10.5F);
}

TEST_P(TwoEyes, OneEyeAndTwoMayFollowEachOther) {
    renderer().set_scene(make_scene({{"view", 0.0}}, {"x"}));
    for (int round = 0; round < 2; ++round) {
        renderer().render(frame_of(1.0, 2.0));
        EXPECT_EQ(value_of("x.left"), 1.0F);
        EXPECT_EQ(value_of("x.right"), 2.0F);
        Frame one = frame_of(3.0, 0.0);
        one.eye_count = 1;
        EXPECT_EQ(renderer().render(one).passes.size(), 1U);
        EXPECT_EQ(value_of("x"), 3.0F);
        EXPECT_EQ(renderer().names_of("x"), std::vector<std::string>{"x"});
    }
}

TEST_P(TwoEyes, AChangedParameterReachesBoth) {
    renderer().set_scene(make_scene({{"shared", 3.0}, {"view", 0.0}, {"sum", 0.0}}, {"y", "base"}));
    renderer().render(frame_of(1.0, 2.0));
    renderer().set_parameter("p1", "/value", 10.0);
    const FrameReport& report = renderer().render(frame_of(1.0, 2.0));
    EXPECT_EQ(value_of("y.left"), 11.0F);
    EXPECT_EQ(value_of("y.right"), 12.0F);
    EXPECT_EQ(status(report, 0), PassStatus::cached) << "what did not change is not made anew";
}

TEST_P(TwoEyes, AnIdleEyeLeavesItsOwnTargetEmpty) {
    renderer().set_scene(make_scene({{"half_idle", 0.0}}, {"x"}));
    const FrameReport& report = renderer().render(frame_of(-1.0, 2.0));
    EXPECT_EQ(status(report, 0), PassStatus::idle);
    EXPECT_EQ(status(report, 1), PassStatus::run);
    EXPECT_EQ(value_of("x.left"), 4.0F);
    EXPECT_EQ(value_of("x.right"), 2.0F);
}

TEST_P(TwoEyes, HistoryIsEachEyesOwn) {
    add("trail", {.ports = {previous_port("x"), write_port("out", "x")},
                  .draw = [](const Pass& pass, double) { draw_add("last")(pass, place_of(pass.frame())); }});
    renderer().set_scene(make_scene({{"trail", 0.0}}, {"x"}));
    for (int i = 1; i <= 3; ++i) {
        renderer().render(frame_of(1.0, 10.0));
        EXPECT_EQ(value_of("x.left"), static_cast<float>(i));
        EXPECT_EQ(value_of("x.right"), 10.0F * static_cast<float>(i));
    }
}

Scene stereo_scene(const char* layout, const std::vector<std::string>& outputs) {
    Scene scene = make_scene({{"shared", 3.0}, {"view", 0.5}}, outputs);
    scene.camera.stereo = StereoParams{};
    scene.camera.stereo->layout =
        std::string_view(layout) == "separate" ? StereoLayout::separate : StereoLayout::side_by_side;
    return scene;
}

TEST_P(TwoEyes, SideBySideIsOnePictureOfTwiceTheWidth) {
    renderer().set_scene(stereo_scene("side_by_side", {"x", "base"}));
    const FrameReport& report = renderer().render(frame_of(-2.0, 5.0));
    ASSERT_EQ(report.passes.size(), 4U);
    EXPECT_EQ(report.passes[3].name, "side_by_side.x");
    const Image both = renderer().read("x");
    ASSERT_EQ(both.width, 16);
    ASSERT_EQ(both.height, 4);
    for (int y = 0; y < both.height; ++y) {
        for (int x = 0; x < both.width; ++x) {
            ASSERT_EQ(both.at(x, y, 0), x < 8 ? -1.5F : 5.5F) << x << "," << y;
        }
    }
    EXPECT_EQ(renderer().read("base").width, 8) << "shared by both, so there is one";
    EXPECT_EQ(renderer().names_of("x"), std::vector<std::string>{"x"});
    EXPECT_EQ(drawn(renderer().render(frame_of(-2.0, 5.0))), 0U);
}

TEST_P(TwoEyes, SideBySideShowsTheClearValueOfAnEmptyEye) {
    Scene scene = make_scene({{"half_idle", 0.0}}, {"x"});
    scene.camera.stereo = StereoParams{.layout = StereoLayout::side_by_side};
    renderer().set_scene(std::move(scene));
    renderer().render(frame_of(-1.0, 2.0));
    EXPECT_EQ(renderer().read("x").at(0, 0, 0), 4.0F);
    EXPECT_EQ(renderer().read("x").at(8, 0, 0), 2.0F);
    EXPECT_EQ(status(renderer().render(frame_of(-1.0, -2.0)), 2), PassStatus::idle);
    EXPECT_EQ(value_of("x"), 4.0F);
}

TEST_P(TwoEyes, TheScenesOwnFramesHaveItsTwoEyes) {
    renderer().set_scene(stereo_scene("separate", {"x"}));
    const Frame frame = renderer().still(0.0);
    ASSERT_EQ(frame.eye_count, 2);
    EXPECT_NEAR(glm::distance(frame.eyes[0].eye_mm, frame.eyes[1].eye_mm), 63.0, 1e-9);
    renderer().render(frame);
    EXPECT_EQ(value_of("x.left"), static_cast<float>(frame.eyes[0].eye_mm.x) + 0.5F);
    EXPECT_EQ(value_of("x.right"), static_cast<float>(frame.eyes[1].eye_mm.x) + 0.5F);
}

TEST_P(TwoEyes, DumpsComePerEye) {
    std::vector<std::string> names;
    renderer().set_scene(make_scene({{"view", 0.0}, {"sum", 1.0}}, {"y"}));
    renderer().set_dump({DumpRequest::Kind::names, {"x", "y"}}, [&](CapturedFrame&& frame) {
        for (const CapturedTarget& target : frame.targets) {
            names.push_back(target.name);
        }
    });
    renderer().render(frame_of(1.0, 2.0));
    renderer().finish_captures();
    EXPECT_THAT(names, testing::ElementsAre("x.left", "x.right", "y.left", "y.right"));
    renderer().set_dump({DumpRequest::Kind::names, {"x.right"}}, {});
    renderer().render(frame_of(1.0, 2.0));
    EXPECT_EQ(value_of("x.right"), 2.0F);
    names.clear();
}

TEST_P(TwoEyes, APictureOfTwoEyesIsReadByItsTwoNames) {
    renderer().set_scene(make_scene({{"view", 0.0}}, {"x"}));
    renderer().render(frame_of(1.0, 2.0));
    const auto error = error_of([&] { (void)renderer().read("x"); });
    ASSERT_TRUE(error);
    EXPECT_THAT(error->what(), testing::HasSubstr("'x.left' and 'x.right'"));
}

TEST_P(TwoEyes, OtherNumbersOfEyesAreRefused) {
    renderer().set_scene(make_scene({{"view", 0.0}}, {"x"}));
    for (const int count : {-1, 0, 3}) {
        Frame frame = frame_of(1.0, 2.0);
        frame.eye_count = count;
        EXPECT_TRUE(error_of([&] { renderer().render(frame); })) << count;
    }
    Frame frame = frame_of(1.0, 2.0);
    frame.eye_index = 1;
    EXPECT_TRUE(error_of([&] { renderer().render(frame); }));
}

INSTANTIATE_TEST_SUITE_P(Backends, TwoEyes, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

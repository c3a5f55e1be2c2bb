#include <thread>

#include "tests/runtime/runtime_test.h"

namespace viscera::test {
namespace {

/// A state that grows by one in one column per frame, and stands still when told to.
class WatchTest : public RuntimeTest {
  protected:
    WatchTest() {
        Port out = write_port();
        out.passthrough = "last";
        add("column", {.ports = {out, previous_port()},
                       .prepare =
                           [this](Prepare& prepare, double) {
                               const int x = static_cast<int>(prepare.frame().index % 24);
                               return still_ ? Work::idle("told so")
                                             : Work::update(PixelRect{x, 2, 1, 5}, "a column", 0);
                           },
                       .draw = draw_add("last")});
        add("kept", {.ports = {write_port("out", "y")}, .prepare = prepare_cached, .draw = draw_fill});
    }
    /// Polls until the copy is that of the last frame: what a host does that has time.
    const WatchedTarget& latest(std::string_view name) {
        for (int i = 0; i < 2000; ++i) {
            const WatchedTarget* copy = renderer().watched(name);
            if (copy != nullptr && copy->frames_behind == 0) {
                return *copy;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        throw std::runtime_error("never arrived");
    }
    bool still_ = false;
};

TEST_P(WatchTest, CopiesAreWhatABlockingReadGives) {
    for (const WatchPath path : {WatchPath::deferred, WatchPath::buffered, WatchPath::automatic}) {
        renderer().set_scene(make_scene({{"column", 1.0}, {"kept", 7.0}}, {"x", "y"}, 24, 10));
        renderer().watch({"x", "y"}, path);
        EXPECT_EQ(renderer().watched("x"), nullptr) << "no frame yet";
        for (std::uint64_t index = 0; index < 30; ++index) {
            still_ = index % 7 == 3;
            render(index);
            const Image read = renderer().read("x");
            const WatchedTarget& copy = latest("x");
            EXPECT_TRUE(copy.image.data == read.data) << "frame " << index;
            EXPECT_EQ(copy.frame, index);
            EXPECT_EQ(copy.time_s, renderer().frame(index).time_s);
            EXPECT_TRUE(latest("y").image.data == renderer().read("y").data);
        }
        EXPECT_EQ(latest("y").version, renderer().watched("y")->version);
    }
}

/// Frames as fast as they come, never a wait: each copy is one that a frame really had, and mostly the last
/// but one.
TEST_P(WatchTest, WithoutWaitingCopiesLieLittleBehind) {
    for (const WatchPath path : {WatchPath::deferred, WatchPath::buffered}) {
        renderer().set_scene(make_scene({{"column", 1.0}}, {"x"}, 24, 10));
        renderer().watch({"x"}, path);
        still_ = false;
        std::vector<float> expected(240, 0.0F);
        std::vector<std::vector<float>> history;
        std::size_t answered = 0;
        for (std::uint64_t index = 0; index < 100; ++index) {
            render(index);
            for (int y = 2; y < 7; ++y) {
                expected[static_cast<std::size_t>(y) * 24 + index % 24] += 1.0F;
            }
            history.push_back(expected);
            if (const WatchedTarget* copy = renderer().watched("x")) {
                ++answered;
                ASSERT_TRUE(to_floats(copy->image) == history[copy->frame]) << "frame " << copy->frame;
                EXPECT_EQ(copy->frames_behind, index - copy->frame);
                EXPECT_LE(copy->frames_behind, 8U);
            }
        }
        EXPECT_GT(answered, 50U);
    }
}

TEST_P(WatchTest, WaitingKeepsCopiesWithinOneFrame) {
    for (const WatchPath path : {WatchPath::deferred, WatchPath::buffered}) {
        renderer().set_scene(make_scene({{"column", 1.0}}, {"x"}, 24, 10));
        renderer().watch({"x"}, path);
        still_ = false;
        for (std::uint64_t index = 0; index < 60; ++index) {
            render(index);
            renderer().wait_for_watched(index % 2);
            const WatchedTarget* copy = renderer().watched("x");
            ASSERT_TRUE(copy != nullptr || index == 0);
            if (copy != nullptr) {
                EXPECT_LE(copy->frames_behind, 1U) << "frame " << index;
                EXPECT_EQ(copy->frames_behind, index - copy->frame);
            }
        }
    }
}

TEST_P(WatchTest, EmptyTargetsShowTheirClearValue) {
    Port out = write_port("out", "x", 3.0F);
    add("idle",
        {.ports = {out}, .prepare = [](Prepare&, double) { return Work::idle("so"); }, .draw = draw_fill});
    renderer().set_scene(make_scene({{"idle", 1.0}}, {"x"}, 24, 10));
    renderer().watch({"x"});
    render(0);
    const WatchedTarget* copy = renderer().watched("x");
    ASSERT_NE(copy, nullptr);
    EXPECT_EQ(copy->frames_behind, 0U);
    EXPECT_EQ(copy->image.at(5, 5, 0), 3.0F);
}

TEST_P(WatchTest, ATimelineInPlaceOfAHostChangesNothing) {
    Scene scene = make_scene({{"column", 1.0}}, {"x"}, 24, 10);
    scene.timeline = {{.value = "any",
                       .interpolation = Interpolation::linear,
                       .period_s = 0.0,
                       .keys = {{0.0, {1.0}, {}}}}};
    renderer().set_scene(scene);
    renderer().watch({"x"});
    still_ = false;
    for (std::uint64_t index = 0; index < 3; ++index) {
        render(index);
        EXPECT_EQ(latest("x").frame, index);
        EXPECT_TRUE(latest("x").image.data == renderer().read("x").data);
    }
}

TEST_P(WatchTest, WhatIsNoTargetIsSaid) {
    renderer().set_scene(make_scene({{"column", 1.0}}, {"x"}, 24, 10));
    renderer().watch({"nothing"});
    const auto error = error_of([&] { render(0); });
    ASSERT_TRUE(error);
    EXPECT_THAT(error->what(), testing::HasSubstr("nothing"));
    renderer().watch({});
    render(1);
    EXPECT_EQ(renderer().watched("x"), nullptr);
}

INSTANTIATE_TEST_SUITE_P(Backends, WatchTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

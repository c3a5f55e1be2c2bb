#include <set>
#include <thread>

#include "engine/gl/texture.h"
#include "tests/embed/recorder.h"
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
        add("growing", {.ports = {out, previous_port()},
                        .prepare =
                            [](Prepare& prepare, double) {
                                const int width = 1 + static_cast<int>(prepare.frame().index % 24);
                                return Work::update(PixelRect{0, 2, width, 5}, "a growing part", 0);
                            },
                        .draw = draw_add("last")});
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
    }
}

TEST_P(WatchTest, AVersionBelongsToOnePicture) {
    std::set<std::uint64_t> seen;
    for (const double value : {1.0, 2.0, 2.0}) {
        renderer().set_scene(make_scene({{"column", value}, {"kept", value}}, {"x", "y"}, 24, 10));
        renderer().watch({"x", "y"});
        still_ = false;
        render(0);
        const std::uint64_t of_y = latest("y").version;
        EXPECT_TRUE(seen.insert(of_y).second) << "another scene's picture had it";
        for (std::uint64_t index = 1; index < 4; ++index) {
            render(index);
            EXPECT_TRUE(seen.insert(latest("x").version).second) << "another picture had it";
            EXPECT_EQ(latest("y").version, of_y) << "nothing has changed";
        }
        still_ = true;
        const std::uint64_t of_x = latest("x").version;
        render(4);
        EXPECT_EQ(latest("x").version, of_x) << "nothing has changed";
    }
}

TEST_P(WatchTest, ACopyOfAnotherSceneIsNone) {
    renderer().watch({"x"});
    renderer().set_scene(make_scene({{"column", 1.0}}, {"x"}, 24, 10));
    render(0);
    EXPECT_EQ(latest("x").image.at(0, 3, 0), 1.0F);
    renderer().set_scene(make_scene({{"column", 5.0}}, {"x"}, 24, 10));
    renderer().wait_for_watched(0);
    EXPECT_EQ(renderer().watched("x"), nullptr) << "the frame before was of another scene";
    render(0);
    EXPECT_EQ(latest("x").image.at(0, 3, 0), 5.0F);
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
            ASSERT_NE(copy, nullptr);
            EXPECT_LE(copy->frames_behind, index % 2) << "frame " << index;
            EXPECT_EQ(copy->frames_behind, index - copy->frame);
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

/// The same where the test says when the GPU is done.
class SlowWatchTest : public WatchTest {
  protected:
    SlowWatchTest() { proc_ = recorder_.proc(); }
    Recorder recorder_{context().proc_address()};
};

TEST_P(SlowWatchTest, WhoOnlyPollsNeverWaits) {
    for (const WatchPath path : {WatchPath::deferred, WatchPath::buffered}) {
        renderer().set_scene(make_scene({{"column", 1.0}}, {"x"}, 24, 10));
        renderer().watch({"x"}, path);
        render(0);
        (void)latest("x");
        recorder_.hold_fences();
        const std::size_t waits = recorder_.waits();
        for (std::uint64_t index = 1; index < 10; ++index) {
            render(index);
            const WatchedTarget* copy = renderer().watched("x");
            ASSERT_NE(copy, nullptr);
            EXPECT_EQ(copy->frame, 0U);
            EXPECT_EQ(copy->frames_behind, index);
        }
        EXPECT_EQ(recorder_.waits(), waits);
        recorder_.hold_fences(false);
    }
}

TEST_P(SlowWatchTest, WhatTheLastFramesChangedComesWithoutAnotherFrame) {
    for (const WatchPath path : {WatchPath::deferred, WatchPath::buffered}) {
        for (const bool waits : {false, true}) {
            renderer().set_scene(make_scene({{"column", 1.0}}, {"x"}, 24, 10));
            renderer().watch({"x"}, path);
            recorder_.hold_fences();
            for (std::uint64_t index = 0; index < 7; ++index) {
                render(index);
                EXPECT_EQ(renderer().watched("x"), nullptr);
            }
            if (waits) {
                renderer().wait_for_watched(0);
            } else {
                recorder_.hold_fences(false);
            }
            const WatchedTarget& copy = latest("x");
            EXPECT_EQ(copy.frame, 6U);
            EXPECT_TRUE(copy.image.data == renderer().read("x").data);
            recorder_.hold_fences(false);
        }
    }
}

/// After its frame a texture of the host's may hold anything.
TEST_P(SlowWatchTest, ATextureOfTheHostsIsAskedForWithItsFrameOnly) {
    gl::Texture host = gl::Texture::make_2d(gl(), 8, 4, PixelFormat::r32f, "host");
    const ImportedTexture imported{.target = "host",
                                   .texture = host.id(),
                                   .format = PixelFormat::r32f,
                                   .width = 8,
                                   .height = 4,
                                   .writable = true};
    const ImportedTarget expected{"host", PixelFormat::r32f, 8, 4, true};
    add("index", {.ports = {write_port()}, .draw = [](const Pass& pass, double) {
                      draw_fill(pass, static_cast<double>(pass.frame().index));
                  }});
    renderer().set_scene(make_scene({{"index", 1.0, {{"out", "host"}}}}, {"host"}), std::span(&expected, 1));
    renderer().watch({"host"}, WatchPath::deferred);
    const auto render_host = [&](std::uint64_t index) {
        Frame frame = renderer().frame(index);
        frame.imported = std::span(&imported, 1);
        renderer().render(frame);
    };
    recorder_.hold_fences();
    render_host(4);
    render_host(5);
    const std::vector<float> of_the_host(32, 99.0F);
    host.upload(std::as_bytes(std::span(of_the_host)));
    recorder_.hold_fences(false);
    renderer().wait_for_watched(0);
    const WatchedTarget* copy = renderer().watched("host");
    ASSERT_NE(copy, nullptr);
    EXPECT_EQ(copy->frames_behind, 1U);
    EXPECT_EQ(copy->image.at(3, 2, 0), 4.0F);
    render_host(6);
    EXPECT_EQ(latest("host").image.at(3, 2, 0), 6.0F);
}

TEST_P(SlowWatchTest, WhatTheDriverLosesIsNoAnswerAndIsAskedForAnew) {
    renderer().set_scene(make_scene({{"column", 1.0}}, {"x"}, 24, 10));
    renderer().watch({"x"}, WatchPath::buffered);
    render(0);
    (void)latest("x");
    recorder_.hold_fences();
    render(1);
    render(2);
    recorder_.hold_fences(false);
    recorder_.lose_mapping();
    const auto error = error_of([&] { renderer().wait_for_watched(0); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::gl);
    recorder_.hold_fences();
    still_ = true;
    render(3);
    EXPECT_EQ(renderer().watched("x"), nullptr);
    recorder_.hold_fences(false);
    EXPECT_EQ(latest("x").frame, 3U);
    EXPECT_TRUE(latest("x").image.data == renderer().read("x").data);
}

TEST_P(SlowWatchTest, BuffersOfFormerSizesDoNotPileUp) {
    renderer().set_scene(make_scene({{"growing", 1.0}}, {"x"}, 24, 10));
    renderer().watch({"x"}, WatchPath::buffered);
    render(0);
    const std::size_t of_the_renderer = recorder_.alive()["Buffers"] - 1;
    for (std::uint64_t index = 1; index < 24; ++index) {
        recorder_.hold_fences(index % 4 != 0);
        render(index);
        if (index % 4 == 0) {
            EXPECT_TRUE(latest("x").image.data == renderer().read("x").data);
        }
    }
    EXPECT_LE(recorder_.alive()["Buffers"], of_the_renderer + 4);
}

INSTANTIATE_TEST_SUITE_P(Backends, WatchTest, each_backend(), backend_name);
INSTANTIATE_TEST_SUITE_P(Backends, SlowWatchTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

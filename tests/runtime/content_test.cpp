#include "engine/core/error.h"
#include "engine/gl/pixel_transfer.h"
#include "tests/runtime/runtime_test.h"

namespace viscera::test {
namespace {

class Content : public RuntimeTest {
  protected:
    Content() {
        add("fill", {.ports = {write_port()}, .draw = draw_fill});
        add("kept", {.ports = {write_port()}, .prepare = prepare_cached, .draw = draw_fill});
        add("add", {.ports = {write_port(), read_port()}, .draw = draw_add("in")});
        add("feedback", {.ports = {write_port(), previous_port()}, .draw = draw_add("last")});
        add("blend", {.ports = {modify_port()}, .draw = [](const Pass& pass, double value) {
                          pass.raster(gl::max_blend_state);
                          draw_fill(pass, value);
                      }});
    }
};

TEST_P(Content, NullUnbindsAnOptionalPortAndNoOther) {
    Port optional = read_port();
    optional.optional = true;
    add("looks", {.ports = {write_port(), optional},
                  .draw = [](const Pass& pass, double) { draw_fill(pass, pass.has("in") ? 1.0 : 2.0); }});
    const auto scene = [](const char* reader, const char* binding) {
        return parse_scene(std::string(R"({"version": 1, "resolution": [8, 4], "outputs": ["y"], "passes": [
            {"name": "a", "effect": "fill", "targets": {"out": "x"}},
            {"name": "b", "effect": ")") +
                               reader + R"(", "targets": {"out": "y", "in": )" + binding + "}}]}",
                           "test.json");
    };
    renderer().set_scene(scene("looks", "\"x\""));
    render(0);
    EXPECT_EQ(value_of("y"), 1.0F);
    renderer().set_scene(scene("looks", "null"));
    EXPECT_EQ(status(render(1), 0), PassStatus::culled);
    EXPECT_EQ(value_of("y"), 2.0F);
    try {
        renderer().set_scene(scene("add", "null"));
        ADD_FAILURE() << "a port that is needed was left unbound";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(),
                    testing::HasSubstr("/passes/1/targets/in: effect 'add' cannot do without port 'in'"));
    }
}

TEST_P(Content, HistoryStartsClearAndCountsFrames) {
    renderer().set_scene(make_scene({{"feedback", 1.0}}, {"x"}));
    for (std::uint64_t i = 0; i < 5; ++i) {
        render(i);
        EXPECT_EQ(value_of("x"), static_cast<float>(i + 1));
    }
}

TEST_P(Content, TheFirstFrameIsToldThatThereIsNoHistory) {
    add("notes", {.ports = {write_port(), previous_port()},
                  .draw = [](const Pass& pass, double) { draw_fill(pass, pass.has("last") ? 1.0 : 0.0); }});
    renderer().set_scene(make_scene({{"notes", 1.0}}, {"x"}));
    render(0);
    EXPECT_EQ(value_of("x"), 0.0F);
    render(1);
    EXPECT_EQ(value_of("x"), 1.0F);
}

TEST_P(Content, HistorySeesTheEndOfTheLastFrameAndNotTheMiddle) {
    // x = 5, y = last x, x = 5 + 1: the last x is 6, never 5.
    renderer().set_scene(
        make_scene({{"fill", 5.0}, {"feedback", 0.0, {{"out", "y"}}}, {"add", 1.0}}, {"y", "x"}));
    render(0);
    EXPECT_EQ(value_of("y"), 0.0F);
    render(1);
    EXPECT_EQ(value_of("y"), 6.0F);
    EXPECT_EQ(value_of("x"), 6.0F);
}

TEST_P(Content, HistoryBeginsAnewAfterAResize) {
    renderer().set_scene(make_scene({{"feedback", 1.0}}, {"x"}));
    render(0);
    render(1);
    Frame frame = renderer().frame(2);
    frame.width = 5;
    renderer().render(frame);
    EXPECT_EQ(renderer().read("x").width, 5);
    EXPECT_EQ(value_of("x"), 1.0F);
}

TEST_P(Content, AnIdleWriterHandsOnItsHistoryAndLosesNothing) {
    add("odd_frames", {.ports = {[] {
                                     Port port = write_port();
                                     port.passthrough = "last";
                                     return port;
                                 }(),
                                 previous_port()},
                       .prepare =
                           [](Prepare& prepare, double) {
                               return prepare.frame().index % 2 == 1 ? Work::all(0)
                                                                     : Work::idle("an even frame");
                           },
                       .draw = draw_add("last")});
    renderer().set_scene(make_scene({{"odd_frames", 1.0}}, {"x"}));
    for (std::uint64_t i = 0; i < 6; ++i) {
        render(i);
        EXPECT_EQ(value_of("x"), static_cast<float>((i + 1) / 2)) << "frame " << i;
    }
}

TEST_P(Content, ReadingAndWritingOneNameGoesBackAndForth) {
    renderer().set_scene(make_scene({{"fill", 3.0}, {"add", 1.0}, {"add", 10.0}, {"add", 100.0}}, {"x"}));
    for (std::uint64_t i = 0; i < 3; ++i) {
        render(i);
        EXPECT_EQ(value_of("x"), 114.0F);
    }
}

TEST_P(Content, ModifyDrawsIntoWhatIsThere) {
    renderer().set_scene(make_scene({{"fill", 3.0}, {"blend", 2.0}, {"blend", 5.0}, {"blend", 4.0}}, {"x"}));
    render(0);
    EXPECT_EQ(value_of("x"), 5.0F);
}

TEST_P(Content, ModifyOfACachedTargetLeavesTheCacheRight) {
    // The kept pass must not be taken for cached once something was drawn over its content.
    renderer().set_scene(make_scene({{"kept", 3.0}, {"blend", 5.0}}, {"x"}));
    for (std::uint64_t i = 0; i < 3; ++i) {
        render(i);
        EXPECT_EQ(value_of("x"), 5.0F);
    }
    renderer().set_parameter("p1", "/value", 4.0);
    render(3);
    EXPECT_EQ(value_of("x"), 4.0F);
}

TEST_P(Content, AnIdlePassLeavesTheClearValueOrItsPassthrough) {
    Port out = write_port("out", "y", 9.0F);
    const auto idle = [](Prepare&, double) { return Work::idle("nothing to do"); };
    add("idle", {.ports = {out, read_port()}, .prepare = idle, .draw = draw_add("in")});
    out.passthrough = "in";
    add("passes_on", {.ports = {out, read_port()}, .prepare = idle, .draw = draw_add("in")});
    for (const auto& [effect, expected] : {std::pair("idle", 9.0F), std::pair("passes_on", 3.0F)}) {
        renderer().set_scene(make_scene({{"fill", 3.0}, {effect, 1.0}}, {"y"}));
        const FrameReport& report = render(0);
        EXPECT_EQ(value_of("y"), expected) << effect;
        EXPECT_EQ(status(report, 1), PassStatus::idle);
        EXPECT_EQ(report.passes[1].reason, "nothing to do");
    }
}

TEST_P(Content, EmptyOutputsHoldTheirClearValueAndReadersSeeNone) {
    Port second = write_port("second", "b", 7.0F);
    bool empty = false;
    add("pair", {.ports = {write_port("first", "a"), second},
                 .prepare =
                     [&empty](Prepare&, double) {
                         Work work = Work::all(0);
                         work.empty_outputs = empty ? 2U : 0U;
                         return work;
                     },
                 .draw = draw_two});
    bool seen = false;
    add("looks", {.ports = {write_port("out", "y"), read_port("in", "b")},
                  .prepare =
                      [&seen](Prepare& prepare, double) {
                          seen = prepare.has("in");
                          return Work::all(0);
                      },
                  .draw = draw_fill});
    renderer().set_scene(make_scene({{"pair", 2.0}, {"looks", 1.0}}, {"a", "b", "y"}));
    for (const bool now : {false, true, false, true}) {
        empty = now;
        render(0);
        EXPECT_EQ(value_of("a"), 2.0F);
        EXPECT_EQ(value_of("b"), now ? 7.0F : 4.0F);
        EXPECT_EQ(seen, !now);
    }
}

TEST_P(Content, ARegionIsConfinedAndTheRestIsClear) {
    add("part", {.ports = {write_port("out", "x", 7.0F)},
                 .prepare =
                     [](Prepare&, double) {
                         return Work::in_region({2, 1, 100, 2}, "a part", 0);
                     },
                 .draw = draw_fill});
    renderer().set_scene(make_scene({{"part", 3.0}}, {"x"}));
    const FrameReport& report = render(0);
    EXPECT_EQ(status(report, 0), PassStatus::reduced);
    EXPECT_EQ(report.passes[0].reason, "a part");
    const Image image = renderer().read("x");
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            EXPECT_EQ(image.at(x, y, 0), x >= 2 && y >= 1 && y < 3 ? 3.0F : 7.0F) << x << "," << y;
        }
    }
}

TEST_P(Content, RegionsOutsideTheTargetDrawNothing) {
    add("beside", {.ports = {write_port("out", "x", 7.0F)},
                   .prepare =
                       [](Prepare&, double) {
                           return Work::in_region({-9, 50, 5, 5}, "beside", 0);
                       },
                   .draw = draw_fill});
    renderer().set_scene(make_scene({{"beside", 3.0}}, {"x"}));
    render(0);
    EXPECT_EQ(value_of("x"), 7.0F);
}

TEST_P(Content, WhatStaysTheSameIsDrawnOnce) {
    renderer().set_scene(make_scene({{"kept", 3.0}}, {"x"}));
    EXPECT_EQ(status(render(0), 0), PassStatus::run);
    EXPECT_EQ(status(render(1), 0), PassStatus::cached);
    EXPECT_EQ(value_of("x"), 3.0F);
    renderer().set_parameter("p0", "/value", 4.0);
    EXPECT_EQ(status(render(2), 0), PassStatus::run);
    EXPECT_EQ(value_of("x"), 4.0F);
}

TEST_P(Content, WhatNobodyNeedsIsCulledAndNeverPrepared) {
    int prepared = 0;
    add("counts", {.ports = {write_port("out", "unused")},
                   .prepare =
                       [&prepared](Prepare&, double) {
                           ++prepared;
                           return Work::all(0);
                       },
                   .draw = draw_fill});
    renderer().set_scene(make_scene({{"fill", 3.0}, {"counts", 1.0}, {"fill", 9.0, {}, false}}, {"x"}));
    const FrameReport& report = render(0);
    EXPECT_EQ(status(report, 1), PassStatus::culled);
    EXPECT_EQ(status(report, 2), PassStatus::culled);
    EXPECT_EQ(report.passes[2].reason, "disabled");
    EXPECT_EQ(prepared, 0);
    EXPECT_EQ(value_of("x"), 3.0F);
}

TEST_P(Content, ImportedTexturesAreReadAndWrittenAndStayTheHosts) {
    gl::Texture host = gl::Texture::make_2d(gl(), 8, 4, PixelFormat::r32f, "host");
    const std::vector<float> forty(32, 40.0F);
    host.upload(std::as_bytes(std::span(forty)));
    const ImportedTexture imported{.target = "host",
                                   .texture = host.id(),
                                   .format = PixelFormat::r32f,
                                   .width = 8,
                                   .height = 4,
                                   .writable = true};
    const ImportedTarget expected{"host", PixelFormat::r32f, 8, 4, true};
    renderer().set_scene(
        make_scene({{"add", 2.0, {{"in", "host"}}}, {"fill", 6.0, {{"out", "host"}}}}, {"x", "host"}),
        std::span(&expected, 1));
    Frame frame = renderer().frame(0);
    frame.imported = std::span(&imported, 1);
    renderer().render(frame);
    EXPECT_EQ(value_of("x"), 42.0F);
    EXPECT_EQ(gl::read_texture(gl(), host).at(7, 3, 0), 6.0F);
    EXPECT_EQ(gl().IsTexture(host.id()), GL_TRUE);
}

TEST_P(Content, AReadOnlyImportedTextureIsNotWritten) {
    gl::Texture host = gl::Texture::make_2d(gl(), 8, 4, PixelFormat::r32f, "host");
    const ImportedTexture imported{
        .target = "x", .texture = host.id(), .format = PixelFormat::r32f, .width = 8, .height = 4};
    renderer().set_scene(make_scene({{"fill", 2.0}}, {"x"}));
    Frame frame = renderer().frame(0);
    frame.imported = std::span(&imported, 1);
    const auto error = error_of([&] { renderer().render(frame); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::scene);
    EXPECT_THAT(error->what(), testing::HasSubstr("p0"));
    frame.imported = {};
    renderer().render(frame);
    EXPECT_EQ(value_of("x"), 2.0F);
}

INSTANTIATE_TEST_SUITE_P(Backends, Content, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

#include <limits>

#include "tests/runtime/runtime_test.h"

namespace viscera::test {
namespace {

class FrameQuality : public RuntimeTest {
  protected:
    FrameQuality() {
        add("fill", {.ports = {write_port()}, .prepare = prepare_cached, .draw = draw_fill});
        add("history",
            {.ports = {write_port(),
                       {.name = "before", .access = Access::previous, .target = "x", .doc = "Read."}},
             .draw = draw_fill});
    }
    const FrameReport& render_with(const Quality& quality) {
        Frame frame = renderer().frame(0);
        frame.quality = quality;
        return renderer().render(frame);
    }
};

TEST_P(FrameQuality, ResolutionScalesTheTargetsAndFullSizeReturns) {
    renderer().set_scene(make_scene({{"fill", 2.0}}, {"x"}, 20, 10));
    render_with({.resolution = 0.5});
    EXPECT_EQ(renderer().read("x").width, 10);
    EXPECT_EQ(renderer().read("x").height, 5);
    EXPECT_EQ(value_of("x"), 2.0F);
    render_with({.resolution = 0.01});
    EXPECT_EQ(renderer().read("x").width, 1) << "never nothing";
    render_with({});
    EXPECT_EQ(renderer().read("x").width, 20);
    EXPECT_EQ(value_of("x"), 2.0F);
    EXPECT_EQ(status(render_with({}), 0), PassStatus::cached);
}

TEST_P(FrameQuality, WhatReadsTheFrameBeforeKeepsItsSize) {
    renderer().set_scene(make_scene({{"history", 2.0}}, {"x"}, 20, 10));
    render_with({});
    render_with({.resolution = 0.5});
    EXPECT_EQ(renderer().read("x").width, 20);
}

TEST_P(FrameQuality, OutOfRangeIsRefused) {
    renderer().set_scene(make_scene({{"fill", 2.0}}, {"x"}));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Quality& quality :
         {Quality{.step_factor = 0.5}, Quality{.step_factor = nan}, Quality{.resolution = 0.0},
          Quality{.resolution = 1.5}, Quality{.resolution = nan}}) {
        const auto error = error_of([&] { render_with(quality); });
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::usage);
    }
    render_with({});
    EXPECT_EQ(value_of("x"), 2.0F);
}

INSTANTIATE_TEST_SUITE_P(Backends, FrameQuality, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

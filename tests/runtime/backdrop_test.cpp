#include "tests/runtime/runtime_test.h"

namespace viscera::test {
namespace {

/// One pixel, at a place that its parameter gives; the rest of the target keeps its clear value.
Recipe one_pixel(std::string target, float clear) {
    Recipe recipe;
    recipe.ports = {write_port("out", std::move(target), clear)};
    recipe.prepare = [](Prepare& prepare, double) {
        const int x = static_cast<int>(prepare.frame().index);
        return Work::in_region({x, 1, 1, 1}, "one pixel", 0);
    };
    recipe.draw = draw_fill;
    return recipe;
}

using BackdropTest = RuntimeTest;

/// Only what an earlier frame drew is cleared, so nothing of it may stay, and nothing beside it may change.
TEST_P(BackdropTest, ADrawnPartThatMovesLeavesNoTrace) {
    add("pixel", one_pixel("x", -1.0F));
    renderer().set_scene(make_scene({{"pixel", 5.0}}, {"x"}));
    for (std::uint64_t index = 0; index < 5; ++index) {
        render(index);
        const Image image = renderer().read("x");
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const bool drawn = x == static_cast<int>(index) && y == 1;
                EXPECT_EQ(image.at(x, y, 0), drawn ? 5.0F : -1.0F)
                    << "frame " << index << " at " << x << "," << y;
            }
        }
    }
}

/// A pass that sets all of its region costs no clear but beside it.
TEST_P(BackdropTest, ARegionThatIsSetAnywayIsNotCleared) {
    Recipe square;
    square.ports = {write_port("out", "x", -1.0F)};
    square.ports[0].overwrites = true;
    square.prepare = [](Prepare& prepare, double) {
        const int at = static_cast<int>(prepare.frame().index);
        return Work::in_region({at, at, 3, 2}, "a square that moves", 0);
    };
    square.draw = [](const Pass& pass, double value) {
        // Breaks its word in the third frame, which shows what it found.
        if (pass.frame().index != 2) {
            draw_fill(pass, value + static_cast<double>(pass.frame().index));
        }
    };
    add("square", square);
    renderer().set_scene(make_scene({{"square", 5.0}}, {"x"}, 32, 16));
    for (int index = 0; index < 4; ++index) {
        render(static_cast<std::uint64_t>(index));
        const Image image = renderer().read("x");
        const auto in_square = [](int x, int y, int at) {
            return x >= at && x < at + 3 && y >= at && y < at + 2;
        };
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const float found = in_square(x, y, index - 1) ? 4.0F + static_cast<float>(index) : -1.0F;
                const float set = index == 2 ? found : 5.0F + static_cast<float>(index);
                EXPECT_EQ(image.at(x, y, 0), in_square(x, y, index) ? set : -1.0F)
                    << "frame " << index << " at " << x << "," << y;
            }
        }
    }
}

/// Contents that take turns in one texture do not show through each other.
TEST_P(BackdropTest, AWholePictureThatStoodThereBeforeIsGone) {
    add("pixel", one_pixel("y", 0.0F));
    Recipe whole;
    whole.ports = {write_port("out", "x")};
    whole.ports[0].overwrites = true;
    whole.draw = draw_fill;
    add("whole", whole);
    Recipe sum;
    sum.ports = {write_port("out", "z"), read_port("in", "x")};
    sum.draw = draw_add("in");
    add("sum", sum);
    renderer().set_scene(make_scene({{"whole", 3.0}, {"sum", 1.0}, {"pixel", 5.0}}, {"y", "z"}));
    for (std::uint64_t index = 0; index < 3; ++index) {
        render(index);
        const Image image = renderer().read("y");
        for (int x = 0; x < image.width; ++x) {
            EXPECT_EQ(image.at(x, 1, 0), x == static_cast<int>(index) ? 5.0F : 0.0F) << "frame " << index;
            EXPECT_EQ(image.at(x, 2, 0), 0.0F) << "frame " << index;
        }
    }
}

/// One pixel more in each frame; `kept` notes what the pass is told.
Recipe pixels_that_stay(std::string target, std::vector<bool>& kept) {
    Recipe recipe;
    recipe.ports = {write_port("out", std::move(target), -1.0F)};
    recipe.prepare = [](Prepare& prepare, double) { return Work::go_on(prepare.frame().index + 1); };
    recipe.draw = [&kept](const Pass& pass, double value) {
        kept.push_back(pass.kept());
        gl::RasterState state = gl::overwrite_state;
        state.scissor = gl::Rect{static_cast<int>(pass.frame().index), 1, 1, 1};
        gl::apply(pass.gl(), state, {0, 0, pass.size().x, pass.size().y});
        draw_fill(pass, value);
    };
    return recipe;
}

TEST_P(BackdropTest, APictureThatGoesOnIsNotCleared) {
    std::vector<bool> kept;
    add("pixel", pixels_that_stay("x", kept));
    renderer().set_scene(make_scene({{"pixel", 5.0}}, {"x"}));
    for (std::uint64_t index = 0; index < 4; ++index) {
        render(index);
    }
    EXPECT_EQ(kept, (std::vector<bool>{false, true, true, true}));
    const Image image = renderer().read("x");
    for (int x = 0; x < 6; ++x) {
        EXPECT_EQ(image.at(x, 1, 0), x < 4 ? 5.0F : -1.0F) << x;
        EXPECT_EQ(image.at(x, 2, 0), -1.0F) << x;
    }
}

TEST_P(BackdropTest, APictureThatAnotherTookThePlaceOfDoesNotGoOn) {
    std::vector<bool> kept;
    Recipe whole;
    whole.ports = {write_port("out", "x", -1.0F)};
    whole.draw = draw_fill;
    add("whole", whole);
    Recipe sum;
    sum.ports = {write_port("out", "z"), read_port("in", "x")};
    sum.draw = draw_add("in");
    add("sum", sum);
    add("pixel", pixels_that_stay("y", kept));
    renderer().set_scene(make_scene({{"whole", 3.0}, {"sum", 1.0}, {"pixel", 5.0}}, {"y", "z"}));
    for (std::uint64_t index = 0; index < 3; ++index) {
        render(index);
    }
    EXPECT_EQ(kept, (std::vector<bool>{false, false, false}));
    const Image image = renderer().read("y");
    for (int x = 0; x < 6; ++x) {
        EXPECT_EQ(image.at(x, 1, 0), x == 2 ? 5.0F : -1.0F) << x;
    }
}

TEST_P(BackdropTest, WhatRestsIsIdleAndStays) {
    Recipe still;
    still.ports = {write_port("out", "x")};
    still.prepare = [](Prepare&, double) { return Work::rest("stands still", 1); };
    still.draw = draw_fill;
    add("still", still);
    renderer().set_scene(make_scene({{"still", 3.0}}, {"x"}));
    EXPECT_EQ(status(render(0), 0), PassStatus::run);
    const FrameReport& report = render(1);
    EXPECT_EQ(status(report, 0), PassStatus::idle);
    EXPECT_EQ(report.passes[0].reason, "stands still");
    EXPECT_EQ(renderer().read("x").at(3, 1, 0), 3.0F);
    // Where the picture is lost it is drawn again.
    renderer().set_scene(make_scene({{"still", 4.0}}, {"x"}));
    EXPECT_EQ(status(render(2), 0), PassStatus::run);
    EXPECT_EQ(renderer().read("x").at(3, 1, 0), 4.0F);
}

INSTANTIATE_TEST_SUITE_P(Backends, BackdropTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

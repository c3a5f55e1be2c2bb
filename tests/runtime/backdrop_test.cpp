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

INSTANTIATE_TEST_SUITE_P(Backends, BackdropTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

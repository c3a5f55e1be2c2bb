#include "tests/runtime/runtime_test.h"

namespace viscera::test {
namespace {

/// A state that survives frames: each frame adds the parameter to the last one in some rectangles.
class UpdateTest : public RuntimeTest {
  protected:
    using Rects = std::vector<PixelRect>;

    UpdateTest() {
        add("in_parts", accumulate([this](const PixelRegion& region) {
                return region.empty() ? Work::idle("nothing touched")
                                      : Work::update(region, "only what is touched", 0);
            }));
        add("on_top", on_top());
    }
    Recipe accumulate(std::function<Work(const PixelRegion&)> work) {
        Port out = write_port();
        out.passthrough = "last";
        return {.ports = {out, previous_port()},
                .prepare = [this, work](Prepare&, double) { return work(now_); },
                .draw = draw_add("last")};
    }
    /// The same within a frame: of what the pass above made.
    Recipe on_top() {
        Port out = write_port();
        out.passthrough = "in";
        return {.ports = {out, read_port()},
                .prepare =
                    [this](Prepare&, double) {
                        return second_.empty() ? Work::idle("nothing on top")
                                               : Work::update(second_, "only what is on top", 0);
                    },
                .draw = draw_add("in")};
    }
    static void add_to(std::vector<float>& pixels, const PixelRegion& region, float value) {
        for (const PixelRect& r : region.rects()) {
            for (int y = r.y; y < r.y + r.height; ++y) {
                for (int x = r.x; x < r.x + r.width; ++x) {
                    pixels[static_cast<std::size_t>(y * width + x)] += value;
                }
            }
        }
    }
    void expect(const std::vector<float>& pixels, std::uint64_t frame) {
        const Image image = renderer().read("x");
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                ASSERT_EQ(image.at(x, y, 0), pixels[static_cast<std::size_t>(y * width + x)])
                    << "frame " << frame << " at " << x << "," << y;
            }
        }
    }

    static constexpr int width = 24;
    static constexpr int height = 10;
    PixelRegion now_;
    PixelRegion second_;
};

TEST_P(UpdateTest, PartsAddUpAsOnTheCpu) {
    renderer().set_scene(make_scene({{"in_parts", 1.0}, {"on_top", 0.25}}, {"x"}, width, height));
    std::vector<float> pixels(static_cast<std::size_t>(width * height), 0.0F);
    std::uint32_t random = 1;
    const auto pick = [&random](std::uint32_t n) {
        random = random * 1664525U + 1013904223U;
        return static_cast<int>((random >> 16) % n);
    };
    for (std::uint64_t frame = 0; frame < 40; ++frame) {
        now_ = second_ = {};
        for (int i = pick(5); i > 0; --i) {
            now_.add({pick(width) - 2, pick(height) - 2, 1 + pick(6), 1 + pick(4)});
        }
        for (int i = pick(3); i > 0; --i) {
            second_.add({pick(width), pick(height), 1 + pick(4), 1 + pick(4)});
        }
        const FrameReport& report = render(frame);
        EXPECT_EQ(status(report, 0), now_.empty() ? PassStatus::idle : PassStatus::reduced);
        EXPECT_EQ(report.passes[0].reason, now_.empty() ? "nothing touched" : "only what is touched");
        add_to(pixels, now_.confined(width, height), 1.0F);
        add_to(pixels, second_.confined(width, height), 0.25F);
        expect(pixels, frame);
    }
}

TEST_P(UpdateTest, BesideTheRectanglesThePassthroughsClearValueStandsAtFirst) {
    Port out = write_port("out", "x", 3.0F);
    out.passthrough = "last";
    add("first", {.ports = {out, previous_port()},
                  .prepare =
                      [](Prepare&, double) {
                          return Work::update(PixelRect{2, 2, 3, 1}, "a part", 0);
                      },
                  .draw = draw_fill});
    renderer().set_scene(make_scene({{"first", 7.0}}, {"x"}, width, height));
    for (std::uint64_t frame = 0; frame < 3; ++frame) {
        render(frame);
        std::vector<float> pixels(static_cast<std::size_t>(width * height), 3.0F);
        add_to(pixels, PixelRect{2, 2, 3, 1}, 4.0F);
        expect(pixels, frame);
    }
}

TEST_P(UpdateTest, AStateSurvivesAFailedFrame) {
    bool fail = false;
    add("fails",
        {.ports = {write_port("out", "y"), read_port()}, .draw = [&fail](const Pass& pass, double value) {
             if (fail) {
                 throw Error(ErrorCode::gl, "test", "told to fail");
             }
             draw_fill(pass, value);
         }});
    renderer().set_scene(make_scene({{"in_parts", 1.0}, {"fails", 1.0}}, {"x", "y"}, width, height));
    std::vector<float> pixels(static_cast<std::size_t>(width * height), 0.0F);
    for (std::uint64_t frame = 0; frame < 6; ++frame) {
        now_ = PixelRect{static_cast<int>(frame), 0, 4, 4};
        fail = frame == 3;
        if (fail) {
            EXPECT_THROW(render(frame), Error);
            continue;
        }
        render(frame);
        add_to(pixels, now_, 1.0F);
        expect(pixels, frame);
    }
}

/// What a viewer does while a state builds up: it asks for more targets, and its window changes.
TEST_P(UpdateTest, AStateOfItsOwnSizeSurvivesANewPlan) {
    Recipe fixed = accumulate([](const PixelRegion& region) { return Work::update(region, "a part", 0); });
    fixed.ports[0].size = {.width = width, .height = height};
    add("fixed", fixed);
    add("frame_sized", {.ports = {write_port("out", "y")}, .draw = draw_fill});
    renderer().set_scene(make_scene({{"fixed", 1.0}, {"frame_sized", 2.0}}, {"x", "y"}, 8, 4));
    std::vector<float> pixels(static_cast<std::size_t>(width * height), 0.0F);
    for (std::uint64_t frame = 0; frame < 8; ++frame) {
        now_ = PixelRect{static_cast<int>(frame), 0, 4, 4};
        Frame settings = renderer().frame(frame);
        settings.width = frame < 3 ? 8 : 12;
        if (frame == 5) {
            renderer().keep({"x", "y"});
        }
        if (frame == 6) {
            renderer().set_parameter("p1", "/value", 3.0);
        }
        renderer().render(settings);
        add_to(pixels, now_, 1.0F);
        expect(pixels, frame);
    }
    renderer().set_scene(make_scene({{"fixed", 1.0}, {"frame_sized", 2.0}}, {"x", "y"}, 8, 4));
    std::ranges::fill(pixels, 0.0F);
    render(9);
    add_to(pixels, now_, 1.0F);
    expect(pixels, 9);
}

INSTANTIATE_TEST_SUITE_P(Backends, UpdateTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

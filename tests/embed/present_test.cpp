#include <algorithm>
#include <cmath>

#include "tests/embed/embed_test.h"
#include "tests/embed/recorder.h"

namespace viscera::test {
namespace {

using Presented = EmbedTest;

std::array<float, 4> pixel(const Image& image, int x, int y) {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2), image.at(x, y, 3)};
}

bool inside(const PixelRect& r, int x, int y) {
    return x >= r.x && x < r.x + r.width && y >= r.y && y < r.y + r.height;
}

/// Pixels outside a viewport that no longer have the canvas's colour, and inside that still have it.
struct Touched {
    int outside = 0;
    int spared = 0;
};
Touched touched(const Image& image, const PixelRect& viewport) {
    Touched count;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            std::array<float, 4> cleared = HostCanvas::colour;
            std::ranges::for_each(cleared, [](float& v) { v = std::round(v * 255.0F) / 255.0F; });
            const bool same = pixel(image, x, y) == cleared;
            count.outside += !same && !inside(viewport, x, y) ? 1 : 0;
            count.spared += same && inside(viewport, x, y) ? 1 : 0;
        }
    }
    return count;
}

TEST_P(Presented, OnlyInTheViewportOfTheFramebufferThatTheCallerNames) {
    const HostCanvas canvas(gl(), 64, 48);
    const HostCanvas bound(gl(), 64, 48);
    Recorder recorder(context().proc());
    Renderer renderer(recorder.proc(), registry(), options());
    renderer.set_scene(world().everything());
    const PixelRect viewport{10, 5, 30, 25};
    Frame frame = renderer.still(World::time_s);
    frame.present = {.enabled = true, .framebuffer = canvas.framebuffer.id(), .viewport = viewport};
    poison();
    expect_untouched("a presented frame", [&] { renderer.render(frame); });
    unpoison();
    const Touched picture = touched(canvas.read(gl()), viewport);
    EXPECT_EQ(picture.outside, 0);
    EXPECT_EQ(picture.spared, 0);
    EXPECT_EQ(touched(bound.read(gl()), {}).outside, 0) << "the framebuffer that was bound is drawn into";

    // host.main is empty without the host's values: its clear value is shown, and confined no less.
    canvas.framebuffer.bind();
    canvas.framebuffer.clear_colour(0, HostCanvas::colour);
    frame.present.output = "host.main";
    poison();
    expect_untouched("a presented clear value", [&] { renderer.render(frame); });
    unpoison();
    const Image cleared = canvas.read(gl());
    EXPECT_EQ(touched(cleared, viewport).outside, 0);
    EXPECT_EQ(pixel(cleared, 20, 15), (std::array{0.0F, 0.0F, 0.0F, 1.0F}));
    EXPECT_EQ(recorder.default_framebuffer_binds(), 0) << "framebuffer 0 is bound though nobody named it";
}

TEST_P(Presented, ShowsThePicturePixelByPixel) {
    Renderer renderer = make_renderer();
    renderer.set_scene(world().small());
    const HostCanvas canvas(gl(), 96, 80, PixelFormat::rgba32f);
    Frame frame = renderer.still(World::time_s);
    frame.present = {.enabled = true, .framebuffer = canvas.framebuffer.id(), .viewport = {0, 0, 96, 80}};
    renderer.render(frame);
    const Image picture = renderer.read("final");
    const Image shown = canvas.read(gl());
    frame.present.flip_y = true;
    renderer.render(frame);
    const Image flipped = canvas.read(gl());
    for (int y = 0; y < 80; ++y) {
        for (int x = 0; x < 96; ++x) {
            // Sampled in the middle of each texel; the position's last bits may reach for a neighbour.
            const float grey = picture.at(x, y, 0);
            ASSERT_NEAR(shown.at(x, y, 0), grey, 1e-5F) << x << ", " << y;
            ASSERT_EQ(shown.at(x, y, 1), shown.at(x, y, 0));
            ASSERT_EQ(shown.at(x, y, 3), 1.0F);
            ASSERT_NEAR(flipped.at(x, 79 - y, 0), grey, 1e-5F) << x << ", " << y;
        }
    }
}

TEST_P(Presented, EachEyeGoesWhereTheHostSays) {
    Renderer renderer = make_renderer();
    renderer.set_scene(world().small());
    const HostCanvas both(gl(), 192, 80, PixelFormat::rgba32f);
    const HostCanvas left(gl(), 96, 80, PixelFormat::rgba32f);
    const HostCanvas right(gl(), 96, 80, PixelFormat::rgba32f);
    Frame frame = renderer.still(World::time_s);
    frame.eyes = {shifted_view(frame.eyes[0], -40.0, 700.0), shifted_view(frame.eyes[0], 40.0, 700.0)};
    frame.eye_count = 2;
    frame.present = {.enabled = true, .framebuffer = both.framebuffer.id(), .viewport = {0, 0, 192, 80}};
    poison();
    expect_untouched("a frame of two eyes", [&] { renderer.render(frame); });
    unpoison();
    const std::array<Image, 2> pictures{renderer.read("final.left"), renderer.read("final.right")};
    ASSERT_NE(pictures[0].data, pictures[1].data);
    const auto expect_shown = [](const Image& shown, int first, const Image& picture) {
        for (int y = 0; y < 80; ++y) {
            for (int x = 0; x < 96; ++x) {
                ASSERT_NEAR(shown.at(first + x, y, 0), picture.at(x, y, 0), 1e-5F) << x << ", " << y;
            }
        }
    };
    const Image side_by_side = both.read(gl());
    expect_shown(side_by_side, 0, pictures[0]);
    expect_shown(side_by_side, 96, pictures[1]);

    frame.present.framebuffer = left.framebuffer.id();
    frame.present.viewport.width = 96;
    frame.present_right = frame.present;
    frame.present_right.framebuffer = right.framebuffer.id();
    renderer.render(frame);
    expect_shown(left.read(gl()), 0, pictures[0]);
    expect_shown(right.read(gl()), 0, pictures[1]);

    frame.present_right.enabled = false;
    frame.present.output = "final.right";
    renderer.render(frame);
    expect_shown(left.read(gl()), 0, pictures[1]);
}

TEST_P(Presented, IsTheSameWhenTheFrameIsCached) {
    Renderer renderer = make_renderer();
    renderer.set_scene(world().small());
    const HostCanvas first(gl(), 96, 80);
    const HostCanvas second(gl(), 96, 80);
    Frame frame = renderer.still(World::time_s);
    frame.present = {.enabled = true, .framebuffer = first.framebuffer.id(), .viewport = {0, 0, 96, 80}};
    renderer.render(frame);
    frame.present.framebuffer = second.framebuffer.id();
    const FrameReport& report = renderer.render(frame);
    EXPECT_TRUE(std::ranges::none_of(report.passes, [](const PassReport& pass) {
        return pass.status == PassStatus::run || pass.status == PassStatus::reduced;
    }));
    EXPECT_EQ(first.read(gl()).data, second.read(gl()).data);
}

TEST_P(Presented, WhatCannotBeDrawnIntoIsRefused) {
    const auto clean = clean_pictures(world().small(), nullptr);
    Renderer renderer = make_renderer();
    renderer.set_scene(world().small());
    GLuint incomplete = 0;
    gl().GenFramebuffers(1, &incomplete);
    gl().BindFramebuffer(GL_FRAMEBUFFER, incomplete);
    std::vector<unsigned> framebuffers{incomplete, 4711};
    if (GetParam() != HostContext::Kind::osmesa) {
        framebuffers.push_back(0);  // a surfaceless context has none
    }
    for (const unsigned framebuffer : framebuffers) {
        Frame frame = renderer.still(World::time_s);
        frame.present = {.enabled = true, .framebuffer = framebuffer, .viewport = {0, 0, 96, 80}};
        expect_untouched("a bad framebuffer", [&] {
            const auto error = error_of([&] { renderer.render(frame); });
            ASSERT_TRUE(error) << framebuffer;
            EXPECT_EQ(error->code(), ErrorCode::usage) << error->what();
        });
        frame.present.enabled = false;
        renderer.render(frame);
        EXPECT_EQ(differing(clean, pictures(renderer)), std::vector<std::string>{});
    }
    gl().DeleteFramebuffers(1, &incomplete);

    const HostCanvas canvas(gl(), 96, 80);
    Frame frame = renderer.still(World::time_s);
    frame.present = {.enabled = true, .framebuffer = canvas.framebuffer.id(), .viewport = {0, 0, -4, 80}};
    expect_untouched("a negative viewport", [&] {
        const auto error = error_of([&] { renderer.render(frame); });
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::usage);
    });
    frame.present.viewport = {0, 0, 96, 80};
    frame.present.output = "nothing";
    expect_untouched("an unknown output", [&] {
        const auto error = error_of([&] { renderer.render(frame); });
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::usage);
    });
    EXPECT_EQ(touched(canvas.read(gl()), {}).outside, 0);
}

INSTANTIATE_TEST_SUITE_P(Hosts, Presented, each_host(), kind_name);

}  // namespace
}  // namespace viscera::test

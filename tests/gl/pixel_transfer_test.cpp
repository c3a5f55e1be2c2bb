#include "engine/gl/pixel_transfer.h"

#include "tests/gl/drawing.h"
#include "tests/gl/gl_test.h"

namespace viscera::test {
namespace {

using PixelTransferTest = GlTest;

Image filled(int width, int height, PixelFormat format, float value) {
    Image image = make_image(width, height, format);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            image.set(x, y, 0, value);
        }
    }
    return image;
}

/// Polls until something comes. Fails rather than hangs.
std::optional<gl::ReadBack::Result> poll_until_there(gl::ReadBack& read_back, const gl::Functions& gl) {
    gl.Finish();
    for (int i = 0; i < 1000; ++i) {
        if (auto result = read_back.poll()) {
            return result;
        }
    }
    return std::nullopt;
}

TEST_P(PixelTransferTest, FormatsAreKnownBothWays) {
    for (const FormatInfo& format : all_formats()) {
        EXPECT_EQ(gl::pixel_format(gl::texture_format(format.format)), format.format);
    }
    EXPECT_FALSE(gl::pixel_format(gl::r16_format));
}

TEST_P(PixelTransferTest, EveryFormatArrivesInOrderAndInItsOwnType) {
    gl::ReadBack read_back(gl());
    std::vector<Image> sent;
    for (const FormatInfo& format : all_formats()) {
        sent.push_back(filled(5, 3, format.format, static_cast<float>(sent.size()) / 255.0F));
        const gl::Texture texture = gl::Texture::from_image(gl(), sent.back(), "sent");
        read_back.start(texture, sent.size());
    }  // the textures are gone before the pixels are asked for
    EXPECT_EQ(read_back.in_flight(), sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
        const auto result = poll_until_there(read_back, gl());
        ASSERT_TRUE(result);
        EXPECT_EQ(result->tag, i + 1);
        EXPECT_EQ(result->image.format, sent[i].format);
        EXPECT_EQ(result->image.data, sent[i].data);
    }
    EXPECT_FALSE(read_back.poll());
    EXPECT_FALSE(read_back.wait());
}

TEST_P(PixelTransferTest, LaterDrawingDoesNotReachWhatWasAskedFor) {
    gl::ReadBack read_back(gl());
    const Canvas canvas(gl(), 64, 64, PixelFormat::r16f);
    for (int i = 0; i < 20; ++i) {
        canvas.framebuffer.clear_colour(0, {static_cast<float>(i), 0.0F, 0.0F, 0.0F});
        read_back.start(canvas.texture, static_cast<std::uint64_t>(i));
    }
    for (int i = 0; i < 20; ++i) {
        const auto result = read_back.wait();
        ASSERT_TRUE(result);
        EXPECT_EQ(result->tag, static_cast<std::uint64_t>(i));
        EXPECT_EQ(result->image.at(63, 63, 0), static_cast<float>(i));
    }
}

TEST_P(PixelTransferTest, DrawnDepthIsRead) {
    const gl::Texture depth = gl::Texture::make_2d(gl(), 3, 3, PixelFormat::depth32f, "depth");
    const gl::Framebuffer framebuffer(gl(), {}, &depth, "depth");
    gl::apply(gl(), gl::depth_tested_state, {0, 0, 3, 3});
    framebuffer.clear_depth(0.1F);
    gl::ReadBack read_back(gl());
    read_back.start(depth, 0);
    EXPECT_EQ(read_back.wait()->image.at(2, 2, 0), 0.1F);
}

TEST_P(PixelTransferTest, TheHostsPackingDoesNotMatter) {
    gl().PixelStorei(GL_PACK_ALIGNMENT, 8);
    gl().PixelStorei(GL_PACK_ROW_LENGTH, 50);
    gl().ClampColor(GL_CLAMP_READ_COLOR, GL_TRUE);
    const Image image = filled(3, 3, PixelFormat::r32f, 17.5F);
    const gl::Texture texture = gl::Texture::from_image(gl(), image, "bright");
    gl::ReadBack read_back(gl());
    read_back.start(texture, 0);
    EXPECT_EQ(read_back.wait()->image.data, image.data);
    gl().ClampColor(GL_CLAMP_READ_COLOR, GL_TRUE);
    EXPECT_EQ(gl::read_texture(gl(), texture).data, image.data);
}

TEST_P(PixelTransferTest, WhatIsNoPictureIsRefused) {
    const gl::Texture labels = gl::Texture::make_2d(gl(), 2, 2, gl::r8ui_format, "labels");
    const auto error = error_of([&] { (void)gl::read_texture(gl(), labels); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::usage);
}

TEST_P(PixelTransferTest, WhatIsUnderWayMayBeForgotten) {
    const gl::Texture texture = gl::Texture::make_2d(gl(), 8, 8, PixelFormat::rgba8, "forgotten");
    gl::ReadBack read_back(gl());
    read_back.start(texture, 0);
}

INSTANTIATE_TEST_SUITE_P(Backends, PixelTransferTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

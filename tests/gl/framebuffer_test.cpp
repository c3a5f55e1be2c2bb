#include "engine/gl/framebuffer.h"

#include <gmock/gmock.h>

#include "engine/gl/pixel_transfer.h"
#include "engine/gl/raster_state.h"
#include "tests/gl/gl_test.h"

namespace viscera::test {
namespace {

using FramebufferTest = GlTest;
using testing::HasSubstr;

TEST_P(FramebufferTest, ClearsEachAttachmentAlone) {
    const gl::Texture a = gl::Texture::make_2d(gl(), 4, 4, PixelFormat::r16f, "a");
    const gl::Texture b = gl::Texture::make_2d(gl(), 4, 4, PixelFormat::rg16f, "b");
    const gl::Texture depth = gl::Texture::make_2d(gl(), 4, 4, PixelFormat::depth32f, "depth");
    const gl::Framebuffer framebuffer(gl(), std::array{&a, &b}, &depth, "three");
    EXPECT_EQ(framebuffer.width(), 4);
    framebuffer.bind();
    gl::apply(gl(), gl::depth_tested_state, {0, 0, 4, 4});
    framebuffer.clear_colour(0, {0.5F, 0.0F, 0.0F, 0.0F});
    framebuffer.clear_colour(1, {0.25F, 0.75F, 0.0F, 0.0F});
    framebuffer.clear_depth(0.125F);
    EXPECT_EQ(read_texture(gl(), a).at(3, 3, 0), 0.5F);
    EXPECT_EQ(read_texture(gl(), b).at(0, 3, 1), 0.75F);
    EXPECT_EQ(read_texture(gl(), depth).at(1, 2, 0), 0.125F);
}

TEST_P(FramebufferTest, AGapDiscardsItsOutput) {
    const gl::Texture b = gl::Texture::make_2d(gl(), 2, 2, PixelFormat::rgba8, "b");
    const std::array<const gl::Texture*, 2> colours{nullptr, &b};
    const gl::Framebuffer framebuffer(gl(), colours, nullptr, "gap");
    gl::apply(gl(), gl::overwrite_state, {0, 0, 2, 2});
    framebuffer.clear_colour(0, {1.0F, 0.0F, 0.0F, 0.0F});
    framebuffer.clear_colour(1, {0.0F, 1.0F, 0.0F, 0.0F});
    EXPECT_EQ(read_texture(gl(), b).at(0, 0, 0), 0.0F);
    EXPECT_EQ(read_texture(gl(), b).at(0, 0, 1), 1.0F);
}

TEST_P(FramebufferTest, SaysWhyItIsIncomplete) {
    const auto empty = error_of([&] { const gl::Framebuffer none(gl(), {}, nullptr, "contrast.main"); });
    ASSERT_TRUE(empty);
    EXPECT_EQ(empty->code(), ErrorCode::gl);
    EXPECT_THAT(empty->what(), HasSubstr("contrast.main"));
    EXPECT_THAT(empty->what(), HasSubstr("no attachment"));

    const gl::Texture depth = gl::Texture::make_2d(gl(), 2, 2, PixelFormat::depth32f, "depth");
    const auto wrong = error_of([&] { const gl::Framebuffer bad(gl(), depth, "depth as colour"); });
    ASSERT_TRUE(wrong);
    EXPECT_THAT(wrong->what(), HasSubstr("cannot be drawn into"));
    // Asking for the wrong attachment is also an error of the call on some drivers.
    gl::drain_errors(gl());
    expects_messages_ = true;
}

TEST_P(FramebufferTest, RefusesAttachmentsOfDifferentSizes) {
    const gl::Texture a = gl::Texture::make_2d(gl(), 2, 2, PixelFormat::r8, "a");
    const gl::Texture b = gl::Texture::make_2d(gl(), 2, 3, PixelFormat::r8, "b");
    const auto error = error_of([&] {
        const gl::Framebuffer bad(gl(), std::array{&a, &b}, nullptr, "pair");
    });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::usage);
}

INSTANTIATE_TEST_SUITE_P(Backends, FramebufferTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

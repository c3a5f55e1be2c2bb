#include "engine/gl/texture.h"

#include <algorithm>

#include <gmock/gmock.h>

#include "engine/gl/framebuffer.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/gl/raster_state.h"
#include "tests/gl/gl_test.h"

namespace viscera::test {
namespace {

using TextureTest = GlTest;
using testing::HasSubstr;

/// A picture in which every channel of every pixel has a value of its own, exact in all formats.
Image pattern(int width, int height, PixelFormat format) {
    Image image = make_image(width, height, format);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                image.set(x, y, c, static_cast<float>((x * 31 + y * 57 + c * 101) % 256) / 255.0F);
            }
        }
    }
    return image;
}

TEST_P(TextureTest, EveryFormatComesBackBitForBitAtAwkwardSizes) {
    for (const FormatInfo& format : all_formats()) {
        for (const auto& [width, height] : {std::pair{1, 1}, {3, 1}, {1, 5}, {7, 3}, {17, 9}, {64, 2}}) {
            SCOPED_TRACE(std::string(format.name) + " " + std::to_string(width) + " x " +
                         std::to_string(height));
            const Image image = pattern(width, height, format.format);
            const gl::Texture texture = gl::Texture::from_image(gl(), image, "round trip");
            EXPECT_EQ(texture.bytes(), image.data.size());
            EXPECT_EQ(read_texture(gl(), texture).data, image.data);
        }
    }
}

TEST_P(TextureTest, RoundTripsDespiteTheHostsPixelStoreAndBuffers) {
    gl().PixelStorei(GL_UNPACK_ALIGNMENT, 8);
    gl().PixelStorei(GL_UNPACK_ROW_LENGTH, 100);
    gl().PixelStorei(GL_PACK_SKIP_ROWS, 2);
    gl().PixelStorei(GL_PACK_ALIGNMENT, 8);
    const Image image = pattern(5, 3, PixelFormat::rg8);
    const gl::Texture texture = gl::Texture::from_image(gl(), image, "round trip");
    EXPECT_EQ(read_texture(gl(), texture).data, image.data);
}

TEST_P(TextureTest, EveryFormatCanBeDrawnInto) {
    for (const FormatInfo& format : all_formats()) {
        SCOPED_TRACE(format.name);
        const gl::Texture texture = gl::Texture::make_2d(gl(), 3, 5, format.format, "target");
        gl::apply(gl(), gl::RasterState{.depth_test = GL_ALWAYS, .depth_write = true}, {0, 0, 3, 5});
        if (format.is_depth) {
            const gl::Framebuffer framebuffer(gl(), {}, &texture, "depth only");
            framebuffer.clear_depth(0.375F);
        } else {
            const gl::Framebuffer framebuffer(gl(), texture, "colour");
            framebuffer.clear_colour(0, {0.2F, 0.4F, 0.6F, 1.0F});
        }
        const Image image = read_texture(gl(), texture);
        const std::array<float, 4> expected{format.is_depth ? 0.375F : 0.2F, 0.4F, 0.6F, 1.0F};
        // Half of the last place: 8 bits; llvmpipe truncates halves, so a whole one there.
        const float tolerance = format.type == ChannelType::unorm8 ? 0.5F / 255.0F
                                : format.type == ChannelType::half ? 0.0005F
                                                                   : 0.0F;
        for (int c = 0; c < image.channels(); ++c) {
            EXPECT_NEAR(image.at(2, 4, c), expected.at(static_cast<std::size_t>(c)), tolerance);
        }
    }
}

TEST_P(TextureTest, RegionsReachTheirPlace) {
    gl::Texture texture = gl::Texture::make_2d(gl(), 4, 3, PixelFormat::r8, "region");
    texture.upload(make_image(4, 3, PixelFormat::r8));
    const std::array texels{std::byte{1}, std::byte{2}};
    texture.upload_region({2, 1, 0}, {1, 2, 1}, texels);
    const Image image = read_texture(gl(), texture);
    EXPECT_EQ(image.data[1 * 4 + 2], std::byte{1});
    EXPECT_EQ(image.data[2 * 4 + 2], std::byte{2});
    EXPECT_EQ(std::ranges::count(image.data, std::byte{0}), 10);
}

TEST_P(TextureTest, VolumesTakeTheirSlicesInOrder) {
    gl::Texture volume = gl::Texture::make_3d(gl(), {3, 2, 5}, gl::r16_format, "volume");
    EXPECT_EQ(volume.bytes(), 60U);
    std::vector<std::uint16_t> voxels(30);
    for (std::size_t i = 0; i < voxels.size(); ++i) {
        voxels[i] = static_cast<std::uint16_t>(257 * i);
    }
    volume.upload(std::as_bytes(std::span(voxels)));
    const std::array<std::uint16_t, 1> one{4711};
    volume.upload_region({2, 1, 3}, {1, 1, 1}, std::as_bytes(std::span(one)));
    voxels[3 * 6 + 1 * 3 + 2] = 4711;
    std::vector<std::uint16_t> back(30);
    gl::set_tight_packing(gl());
    volume.bind_for_editing();
    gl().GetTexImage(GL_TEXTURE_3D, 0, GL_RED, GL_UNSIGNED_SHORT, back.data());
    EXPECT_EQ(back, voxels);
}

TEST_P(TextureTest, ArraysTakeTheirLayersInOrder) {
    gl::Texture array = gl::Texture::make_2d_array(gl(), {3, 2, 5}, gl::r16_format, "pages");
    EXPECT_EQ(array.target(), static_cast<GLenum>(GL_TEXTURE_2D_ARRAY));
    std::vector<std::uint16_t> texels(30);
    for (std::size_t i = 0; i < texels.size(); ++i) {
        texels[i] = static_cast<std::uint16_t>(257 * i);
    }
    array.upload(std::as_bytes(std::span(texels)));
    const std::array<std::uint16_t, 2> two{4711, 815};
    array.upload_region({2, 1, 3}, {1, 1, 2}, std::as_bytes(std::span(two)));
    texels[3 * 6 + 1 * 3 + 2] = 4711;
    texels[4 * 6 + 1 * 3 + 2] = 815;
    std::vector<std::uint16_t> back(30);
    gl::set_tight_packing(gl());
    array.bind_for_editing();
    gl().GetTexImage(GL_TEXTURE_2D_ARRAY, 0, GL_RED, GL_UNSIGNED_SHORT, back.data());
    EXPECT_EQ(back, texels);
}

TEST_P(TextureTest, ArraysHaveALimitOfTheirOwnForLayers) {
    GLint layers = 0;
    gl().GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    GLint side = 0;
    gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
    const auto make = [&](gl::Extent extent) {
        return error_of([&] { (void)gl::Texture::make_2d_array(gl(), extent, gl::r16_format, "pages"); });
    };
    EXPECT_FALSE(make({1, 1, layers}));
    EXPECT_FALSE(make({side, 1, 1}));
    for (const gl::Extent extent : {gl::Extent{1, 1, layers + 1}, {side + 1, 1, 1}, {1, 0, 1}}) {
        const auto error = make(extent);
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::limit);
        EXPECT_THAT(error->what(), HasSubstr("pages"));
        EXPECT_THAT(error->what(), HasSubstr(std::to_string(layers)));
    }
}

TEST_P(TextureTest, EditingDisturbsNoUnitThatSamples) {
    const gl::Texture sampled = gl::Texture::make_2d(gl(), 2, 2, PixelFormat::rgba8, "sampled");
    for (GLuint unit = 0; unit < gl::editing_unit; ++unit) {
        sampled.bind(unit);
    }
    const gl::Texture other = gl::Texture::from_image(gl(), pattern(2, 2, PixelFormat::r8), "other");
    for (GLuint unit = 0; unit < gl::editing_unit; ++unit) {
        gl().ActiveTexture(GL_TEXTURE0 + unit);
        GLint bound = 0;
        gl().GetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
        EXPECT_EQ(static_cast<GLuint>(bound), sampled.id());
    }
}

TEST_P(TextureTest, OwnershipMovesAndWrappedOnesStayTheHosts) {
    GLuint released = 0;
    {
        gl::Texture a = gl::Texture::make_2d(gl(), 2, 2, PixelFormat::r8, "a");
        const GLuint a_id = a.id();
        gl::Texture b = std::move(a);
        EXPECT_EQ(b.id(), a_id);
        b = gl::Texture::make_2d(gl(), 2, 2, PixelFormat::r8, "b");
        released = b.release();
        EXPECT_EQ(b.id(), 0U);
    }
    EXPECT_EQ(gl().IsTexture(released), GL_TRUE);
    {
        const gl::Texture wrapped =
            gl::Texture::wrap(gl(), released, GL_TEXTURE_2D, {2, 2, 1}, gl::texture_format(PixelFormat::r8));
        EXPECT_FALSE(wrapped.owned());
    }
    EXPECT_EQ(gl().IsTexture(released), GL_TRUE);
    GLuint gone = 0;
    { gone = gl::Texture::make_2d(gl(), 2, 2, PixelFormat::r8, "gone").id(); }
    EXPECT_EQ(gl().IsTexture(gone), GL_FALSE);
    gl().DeleteTextures(1, &released);
}

TEST_P(TextureTest, SizesBeyondTheDeviceAreNamed) {
    for (const auto& [width, height] : {std::pair{0, 4}, {4, -1}, {1 << 20, 1}}) {
        const auto error =
            error_of([&] { (void)gl::Texture::make_2d(gl(), width, height, PixelFormat::r8, "vessel map"); });
        ASSERT_TRUE(error);
        EXPECT_EQ(error->code(), ErrorCode::limit);
        EXPECT_THAT(error->what(), HasSubstr("vessel map"));
    }
}

TEST_P(TextureTest, UploadsThatDoNotFitAreRefused) {
    gl::Texture texture = gl::Texture::make_2d(gl(), 4, 4, PixelFormat::rgba8, "target");
    const std::vector<std::byte> bytes(64);
    const auto code = [&](auto action) {
        const auto error = error_of(action);
        return error ? std::optional(error->code()) : std::nullopt;
    };
    EXPECT_EQ(code([&] { texture.upload(std::span(bytes).first(63)); }), ErrorCode::usage);
    EXPECT_EQ(code([&] { texture.upload_region({1, 0, 0}, {4, 4, 1}, bytes); }), ErrorCode::usage);
    EXPECT_EQ(code([&] { texture.upload_region({-1, 0, 0}, {4, 4, 1}, bytes); }), ErrorCode::usage);
    EXPECT_EQ(code([&] { texture.upload(make_image(4, 4, PixelFormat::r32f)); }), ErrorCode::usage);
    EXPECT_EQ(code([&] { texture.upload(make_image(2, 8, PixelFormat::rgba8)); }), ErrorCode::usage);
    EXPECT_EQ(code([&] { texture.upload(bytes); }), std::nullopt);
}

INSTANTIATE_TEST_SUITE_P(Backends, TextureTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

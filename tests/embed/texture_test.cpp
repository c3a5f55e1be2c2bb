#include <gmock/gmock.h>

#include "engine/gl/pixel_transfer.h"
#include "tests/embed/embed_test.h"
#include "tests/embed/recorder.h"

namespace viscera::test {
namespace {

using Exchanged = EmbedTest;

/// A texture of the host, r16f with one value everywhere.
gl::Texture grey(const gl::Functions& gl, float value, int width = 32, int height = 32) {
    gl::Texture texture = gl::Texture::make_2d(gl, width, height, PixelFormat::r16f, "host");
    const std::vector<unsigned short> texels(
        static_cast<std::size_t>(width) * static_cast<std::size_t>(height), float_to_half(value));
    texture.upload(std::as_bytes(std::span(texels)));
    return texture;
}

/// `small` with a background that the host brings.
Scene without_background(const World& world) {
    Scene scene = world.small();
    scene.passes.erase(scene.passes.begin());
    return scene;
}

/// Value in a corner, where there is nothing but background.
float corner(Renderer& renderer) {
    return renderer.read("final").at(1, 1, 0);
}

class ImportedBackground {
  public:
    explicit ImportedBackground(const gl::Texture& texture, std::uint64_t version = 0) {
        textures_[0] = {.target = "background",
                        .texture = texture.id(),
                        .format = PixelFormat::r16f,
                        .width = texture.width(),
                        .height = texture.height(),
                        .version = version};
    }
    [[nodiscard]] std::span<const ImportedTexture> textures() const { return textures_; }
    [[nodiscard]] static std::vector<ImportedTarget> expected() {
        return {{.name = "background", .format = PixelFormat::r16f, .width = 32, .height = 32}};
    }

  private:
    std::array<ImportedTexture, 1> textures_;
};

TEST_P(Exchanged, AnImportedTextureIsReadAndLeftAlone) {
    const gl::Texture bright = grey(gl(), 0.75F);
    gl::Texture dark = grey(gl(), 0.25F);
    Renderer renderer = make_renderer();
    renderer.set_scene(without_background(world()), ImportedBackground::expected());
    Frame frame = renderer.still(World::time_s);
    const ImportedBackground first(bright, 1);
    frame.imported = first.textures();
    poison();
    expect_untouched("an imported texture", [&] { renderer.render(frame); });
    unpoison();
    EXPECT_EQ(corner(renderer), 0.75F);
    EXPECT_EQ(gl::read_texture(gl(), bright).at(5, 5, 0), 0.75F);

    // Another texture is another picture, even with a version that was used before.
    const ImportedBackground second(dark, 1);
    frame.imported = second.textures();
    renderer.render(frame);
    EXPECT_EQ(corner(renderer), 0.25F);

    // New content under the same name: seen with a new version, and with version 0 at once.
    const std::vector<unsigned short> texels(32 * 32, float_to_half(0.5F));
    dark.upload(std::as_bytes(std::span(texels)));
    const ImportedBackground third(dark, 2);
    frame.imported = third.textures();
    renderer.render(frame);
    EXPECT_EQ(corner(renderer), 0.5F);
}

TEST_P(Exchanged, AWritableTextureIsDrawnIntoWhicheverTheHostBrings) {
    const auto clean = clean_pictures(world().small(), nullptr);
    Recorder recorder(context().proc());
    Renderer renderer(recorder.proc(), registry(), options());
    const ImportedTarget target{
        .name = "final", .format = PixelFormat::r16f, .width = 96, .height = 80, .writable = true};
    renderer.set_scene(world().small(), std::span(&target, 1));
    const auto render_into = [&](const gl::Texture& texture) {
        const ImportedTexture imported{.target = "final",
                                       .texture = texture.id(),
                                       .format = PixelFormat::r16f,
                                       .width = 96,
                                       .height = 80,
                                       .writable = true,
                                       .version = 1};
        Frame frame = renderer.still(World::time_s);
        frame.imported = std::span(&imported, 1);
        renderer.render(frame);
        EXPECT_EQ(renderer.texture("final"), texture.id());
        return gl::read_texture(gl(), texture);
    };
    const gl::Texture front = grey(gl(), 0.0F, 96, 80);
    const gl::Texture back = grey(gl(), 0.0F, 96, 80);
    EXPECT_EQ(render_into(front).data, clean.at("final").data);
    EXPECT_EQ(render_into(back).data, clean.at("final").data);
    EXPECT_EQ(render_into(front).data, clean.at("final").data);
    // A host may delete its texture, and the next one may get the same name.
    const gl::Texture young = grey(gl(), 0.0F, 96, 80);
    recorder.reuse_name(front.id(), young.id());
    (void)render_into(front);
    EXPECT_EQ(gl::read_texture(gl(), young).data, clean.at("final").data);
}

TEST_P(Exchanged, ATextureThatIsNoneIsRefused) {
    Renderer renderer = make_renderer();
    renderer.set_scene(without_background(world()), ImportedBackground::expected());
    for (const unsigned name : {0U, 4711U}) {
        const ImportedTexture imported{
            .target = "background", .texture = name, .format = PixelFormat::r16f, .width = 32, .height = 32};
        Frame frame = renderer.still(World::time_s);
        frame.imported = std::span(&imported, 1);
        expect_untouched("no texture", [&] {
            const auto error = error_of([&] { renderer.render(frame); });
            ASSERT_TRUE(error) << name;
            EXPECT_EQ(error->code(), ErrorCode::usage) << error->what();
        });
    }
    // Brought no longer: refused every time, not only the first.
    for (int i = 0; i < 2; ++i) {
        const auto error = error_of([&] { renderer.render(renderer.still(World::time_s)); });
        ASSERT_FALSE(error) << "a background is optional: " << error->what();
    }
    const gl::Texture bright = grey(gl(), 0.75F);
    const ImportedBackground good(bright);
    Frame frame = renderer.still(World::time_s);
    frame.imported = good.textures();
    renderer.render(frame);
    EXPECT_EQ(corner(renderer), 0.75F);
}

TEST_P(Exchanged, ATextureThatIsNotWhatTheHostSaysIsRefused) {
    Renderer renderer = make_renderer();
    renderer.set_scene(without_background(world()), ImportedBackground::expected());
    const gl::Texture small = grey(gl(), 0.5F, 16, 32);
    const gl::Texture depth = gl::Texture::make_2d(gl(), 32, 32, PixelFormat::depth32f, "depth");
    const gl::Texture deep =
        gl::Texture::make_3d(gl(), {32, 32, 1}, gl::texture_format(PixelFormat::r16f), "deep");
    const auto refusal = [&](const gl::Texture& texture) {
        const ImportedTexture imported{.target = "background",
                                       .texture = texture.id(),
                                       .format = PixelFormat::r16f,
                                       .width = 32,
                                       .height = 32};
        Frame frame = renderer.still(World::time_s);
        frame.imported = std::span(&imported, 1);
        std::string text;
        expect_untouched("another texture", [&] {
            const auto error = error_of([&] { renderer.render(frame); });
            text = error && error->code() == ErrorCode::usage ? error->what() : "";
        });
        return text;
    };
    EXPECT_THAT(refusal(small), testing::HasSubstr("is 16 x 32, not 32 x 32"));
    EXPECT_THAT(refusal(depth), testing::HasSubstr("holds depth, not colour"));
    EXPECT_THAT(refusal(deep), testing::HasSubstr("is not a 2-D texture"));
}

TEST_P(Exchanged, AnImportThatDoesNotFitIsRefusedEveryTime) {
    Renderer renderer = make_renderer();
    renderer.set_scene(world().small());
    renderer.render(renderer.still(World::time_s));
    const auto clean = pictures(renderer);
    const gl::Texture texture = grey(gl(), 0.5F, 96, 80);
    // The scene draws "final", which the host does not allow.
    const ImportedTexture imported{
        .target = "final", .texture = texture.id(), .format = PixelFormat::r16f, .width = 96, .height = 80};
    for (int i = 0; i < 3; ++i) {
        Frame frame = renderer.still(World::time_s);
        frame.imported = std::span(&imported, 1);
        expect_untouched("a read-only output", [&] {
            const auto error = error_of([&] { renderer.render(frame); });
            ASSERT_TRUE(error) << "time " << i;
            EXPECT_EQ(error->code(), ErrorCode::scene) << error->what();
        });
    }
    renderer.render(renderer.still(World::time_s));
    EXPECT_EQ(differing(clean, pictures(renderer)), std::vector<std::string>{});
}

TEST_P(Exchanged, AnOutputsTextureIsReadByItsName) {
    Renderer renderer = make_renderer();
    renderer.set_scene(world().small());
    EXPECT_EQ(renderer.texture("final"), 0U);
    renderer.render(renderer.still(World::time_s));
    const GLuint name = renderer.texture("final");
    ASSERT_EQ(gl().IsTexture(name), GL_TRUE);
    const auto wrapped =
        gl::Texture::wrap(gl(), name, GL_TEXTURE_2D, {96, 80}, gl::texture_format(PixelFormat::r16f));
    EXPECT_EQ(gl::read_texture(gl(), wrapped).data, renderer.read("final").data);
    EXPECT_EQ(renderer.texture("nothing"), 0U);
}

TEST_P(Exchanged, AReleasedTextureStaysTheHosts) {
    GLuint name = 0;
    Image picture;
    {
        Renderer renderer = make_renderer();
        renderer.set_scene(world().small());
        renderer.render(renderer.still(World::time_s));
        picture = renderer.read("final");
        name = renderer.release_texture("final");
        renderer.render(renderer.still(World::time_s + 0.3));
        EXPECT_NE(renderer.texture("final"), name);
    }
    ASSERT_EQ(gl().IsTexture(name), GL_TRUE);
    const auto wrapped =
        gl::Texture::wrap(gl(), name, GL_TEXTURE_2D, {96, 80}, gl::texture_format(PixelFormat::r16f));
    EXPECT_EQ(gl::read_texture(gl(), wrapped).data, picture.data);
    gl().DeleteTextures(1, &name);
}

INSTANTIATE_TEST_SUITE_P(Hosts, Exchanged, each_host(), kind_name);

}  // namespace
}  // namespace viscera::test

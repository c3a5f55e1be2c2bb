#include "engine/gl/raster_state.h"

#include "engine/gl/buffer.h"
#include "tests/gl/drawing.h"
#include "tests/gl/gl_test.h"

namespace viscera::test {
namespace {

/// Draws full-screen triangles of one value and depth. What the presets make of overlapping ones.
class RasterStateTest : public GlTest {
  protected:
    struct Layer {
        float value = 0.0F;
        float depth = 0.0F;  ///< clip space
    };
    void draw(const Layer& layer) {
        program_.use();
        program_.set("value", layer.value);
        program_.set("depth", layer.depth);
        vertices_.bind();
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
    }
    [[nodiscard]] float result(const gl::RasterState& state, std::span<const Layer> layers) {
        const gl::Texture colour = gl::Texture::make_2d(gl(), 4, 4, PixelFormat::rgba32f, "colour");
        const gl::Texture depth = gl::Texture::make_2d(gl(), 4, 4, PixelFormat::depth32f, "depth");
        const gl::Framebuffer framebuffer(gl(), std::array{&colour}, &depth, "layers");
        framebuffer.bind();
        gl::apply(gl(), gl::depth_tested_state, {0, 0, 4, 4});
        framebuffer.clear_colour(0, {});
        framebuffer.clear_depth(1.0F);
        gl::apply(gl(), state, {0, 0, 4, 4});
        for (const Layer& layer : layers) {
            draw(layer);
        }
        return gl::read_texture(gl(), colour).at(1, 2, 0);
    }

    gl::VertexArray vertices_{gl()};
    gl::Program program_{gl(),
                         shader("#version 330 core\nuniform float depth;\n"
                                "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * "
                                "4.0 - 1.0, depth, 1.0); }\n"),
                         shader("#version 330 core\nuniform float value; out vec4 colour;\nvoid main() { "
                                "colour = vec4(value); }\n"),
                         "layers"};
    static constexpr std::array<Layer, 3> layers_{{{0.25F, 0.5F}, {0.75F, -0.5F}, {0.5F, 0.0F}}};
};

TEST_P(RasterStateTest, PresetsDoWhatTheirNamesSay) {
    EXPECT_EQ(result(gl::overwrite_state, layers_), 0.5F);
    EXPECT_EQ(result(gl::max_blend_state, layers_), 0.75F);
    EXPECT_EQ(result(gl::add_blend_state, layers_), 1.5F);
    EXPECT_EQ(result(gl::depth_tested_state, layers_), 0.75F);
}

TEST_P(RasterStateTest, CullingSeesTheFrontFace) {
    // The full-screen triangle runs counter-clockwise.
    EXPECT_EQ(result({.cull = GL_BACK}, layers_), 0.5F);
    EXPECT_EQ(result({.cull = GL_FRONT}, layers_), 0.0F);
    EXPECT_EQ(result({.cull = GL_BACK, .front_face = GL_CW}, layers_), 0.0F);
}

TEST_P(RasterStateTest, ScissorAndMaskConfine) {
    const Canvas canvas(gl(), 4, 4);
    canvas.begin(gl(), {.colour_mask = {true, false, true, true}, .scissor = gl::Rect{1, 2, 2, 1}});
    draw({1.0F, 0.0F});
    const Image image = canvas.read(gl());
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 4; ++x) {
            const bool inside = y == 2 && (x == 1 || x == 2);
            EXPECT_EQ(image.at(x, y, 0), inside ? 1.0F : 0.0F);
            EXPECT_EQ(image.at(x, y, 1), 0.0F);
        }
    }
}

TEST_P(RasterStateTest, DepthClampKeepsWhatLiesBehindTheFarPlane) {
    const std::array<Layer, 1> behind{{{0.5F, 1.5F}}};
    EXPECT_EQ(result(gl::overwrite_state, behind), 0.0F);
    EXPECT_EQ(result({.depth_clamp = true}, behind), 0.5F);
}

INSTANTIATE_TEST_SUITE_P(Backends, RasterStateTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

#include "engine/gl/program.h"

#include <gmock/gmock.h>

#include "engine/gl/buffer.h"
#include "tests/gl/drawing.h"
#include "tests/gl/gl_test.h"

namespace viscera::test {
namespace {

using testing::HasSubstr;

class ProgramTest : public GlTest {
  protected:
    [[nodiscard]] gl::Program make(const std::string& fragment) {
        return {gl(), full_screen(), shader("#version 330 core\nout vec4 colour;\n" + fragment),
                "test/program"};
    }
    [[nodiscard]] glm::vec4 pixel(const gl::Program& program) {
        const Canvas canvas(gl(), 1, 1);
        program.use();
        vertices_.bind();
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
        const Image image = canvas.read(gl());
        return {image.at(0, 0, 0), image.at(0, 0, 1), image.at(0, 0, 2), image.at(0, 0, 3)};
    }
    gl::VertexArray vertices_{gl()};
};

TEST_P(ProgramTest, EveryKindOfUniformArrives) {
    const gl::Program program = make(R"(
uniform bool b; uniform int i; uniform uint u; uniform float f; uniform vec2 v2; uniform vec3 v3; uniform vec4 v4;
uniform ivec2 i2; uniform ivec3 i3; uniform ivec4 i4; uniform mat3 m3; uniform mat4 m4;
void main() {
    colour = vec4(b ? 1.0 : 0.0, float(i), float(u), f) + v4 + vec4(v2, 0.0, 0.0) + vec4(v3, 0.0)
           + vec4(i2, 0, 0) + vec4(i3, 0) + vec4(i4) + vec4(m3 * vec3(1.0, 0.0, 0.0), 0.0) + m4 * vec4(0.0, 0.0, 0.0, 1.0);
})");
    program.use();
    program.set("b", true);
    program.set("i", -2);
    program.set("u", 3U);
    program.set("f", 0.5F);
    program.set("v2", glm::vec2(10, 20));
    program.set("v3", glm::vec3(100, 200, 300));
    program.set("v4", glm::vec4(1000, 2000, 3000, 4000));
    program.set("i2", glm::ivec2(1, 2));
    program.set("i3", glm::ivec3(3, 4, 5));
    program.set("i4", glm::ivec4(6, 7, 8, 9));
    program.set("m3", glm::mat3(0.25F));
    glm::mat4 matrix(1.0F);
    matrix[3] = glm::vec4(0.125F, 0.25F, 0.5F, 1.0F);
    program.set("m4", matrix);
    EXPECT_EQ(pixel(program), glm::vec4(1 + 1000 + 10 + 100 + 1 + 3 + 6 + 0.25F + 0.125F,
                                        -2 + 2000 + 20 + 200 + 2 + 4 + 7 + 0.25F,
                                        3 + 3000 + 300 + 5 + 8 + 0.5F, 0.5F + 4000 + 9 + 1));
}

TEST_P(ProgramTest, ArraysArriveAndWhatIsTooMuchIsDropped) {
    const gl::Program program = make(
        "uniform float values[3]; uniform vec3 points[2];\n"
        "void main() { colour = vec4(values[0] + values[1] + values[2], points[1]); }");
    program.use();
    const std::array<float, 5> values{1, 2, 4, 8, 16};
    const std::array<glm::vec3, 2> points{glm::vec3(9), glm::vec3(1, 2, 3)};
    program.set("values", values);
    program.set("points", points);
    EXPECT_EQ(pixel(program), glm::vec4(7, 1, 2, 3));
}

TEST_P(ProgramTest, UnknownNamesAreIgnored) {
    const gl::Program program =
        make("uniform float used; uniform float unused; void main() { colour = vec4(used); }");
    program.use();
    ASSERT_EQ(program.uniforms().size(), 1U);
    EXPECT_EQ(program.uniforms()[0].name, "used");
    program.set("unused", 1.0F);
    program.set("usd", 1.0F);
    program.set("used", 2.0F);
    EXPECT_EQ(pixel(program).x, 2.0F);
}

TEST_P(ProgramTest, SaysWhichUniformHasNoValue) {
    const gl::Program program = make(
        "uniform float first; uniform vec2 second[2]; uniform sampler2D third;\n"
        "void main() { colour = texture(third, second[1]) + first; }");
    EXPECT_EQ(program.unset(), "") << "it has not been used";
    const gl::Texture texture = gl::Texture::make_2d(gl(), 1, 1, PixelFormat::r32f, "one texel");
    const gl::Sampler sampler(gl(), gl::SamplerDesc{});
    for (int time = 0; time < 2; ++time) {
        program.use();
        EXPECT_EQ(program.unset(), "first");
        program.set("first", 1.0F);
        EXPECT_EQ(program.unset(), "second");
        program.set("second", std::span<const glm::vec2>());
        EXPECT_EQ(program.unset(), "third") << "no values are values";
        program.bind("third", texture, sampler);
        EXPECT_EQ(program.unset(), "");
    }
}

TEST_P(ProgramTest, AWrongTypeIsNamed) {
    const gl::Program program = make("uniform float radius_mm; void main() { colour = vec4(radius_mm); }");
    program.use();
    const auto error = error_of([&] { program.set("radius_mm", 3); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::gl);
    EXPECT_THAT(error->what(), HasSubstr("test/program"));
    EXPECT_THAT(error->what(), HasSubstr("radius_mm"));
}

TEST_P(ProgramTest, CompileErrorsNameFileAndLine) {
    ShaderSource fragment =
        shader("#version 330 core\nout vec4 colour;\nvoid main() { colour = vec3(1.0); }\n");
    fragment.files = {"contrast/main.frag", "common/smooth.glsl"};
    fragment.lines = {{0, 1}, {0, 2}, {1, 42}};
    const auto error = error_of([&] { const gl::Program bad(gl(), full_screen(), fragment, "contrast"); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::gl);
    EXPECT_EQ(error->where(), "contrast");
    EXPECT_THAT(error->what(), HasSubstr("common/smooth.glsl:42"));
    expects_messages_ = true;
}

TEST_P(ProgramTest, LinkErrorsCarryTheLog) {
    const ShaderSource vertex = shader(
        "#version 330 core\nout float density;\nvoid main() { density = 1.0; gl_Position = vec4(0.0); }\n");
    const ShaderSource fragment = shader(
        "#version 330 core\nin vec3 density; out vec4 colour;\nvoid main() { colour = vec4(density, 1.0); "
        "}\n");
    const auto error = error_of([&] { const gl::Program bad(gl(), vertex, fragment, "contrast"); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::gl);
    EXPECT_THAT(error->what(), HasSubstr("does not link"));
    EXPECT_THAT(error->what(), HasSubstr("density"));
    expects_messages_ = true;
}

TEST_P(ProgramTest, SamplersHaveUnitsOfTheirOwn) {
    const gl::Program program = make(
        "uniform sampler2D main_map; uniform sampler3D volume; uniform sampler2D pair[2];\n"
        "void main() { colour = vec4(texture(main_map, vec2(0.5)).r, texture(volume, vec3(0.5)).r,\n"
        "    texture(pair[0], vec2(0.5)).r, texture(pair[1], vec2(0.5)).r); }");
    Image image = make_image(1, 1, PixelFormat::r32f);
    image.set(0, 0, 0, 5.0F);
    const gl::Texture flat = gl::Texture::from_image(gl(), image, "flat");
    gl::Texture volume =
        gl::Texture::make_3d(gl(), {1, 1, 1}, gl::texture_format(PixelFormat::r32f), "volume");
    const std::array<float, 1> voxel{7.0F};
    volume.upload(std::as_bytes(std::span(voxel)));
    const gl::Sampler sampler(gl(), {.filter = gl::Filter::nearest});
    program.use();
    program.bind("main_map", flat, sampler);
    program.bind("volume", volume, sampler);
    program.bind("not there", flat, sampler);
    program.bind("pair", flat, sampler);
    EXPECT_EQ(pixel(program), glm::vec4(5.0F, 7.0F, 5.0F, 0.0F));
}

TEST_P(ProgramTest, RowsOfTexelsAreFetchedByNumber) {
    const gl::Program program = make(
        "uniform samplerBuffer row; uniform int number; void main() { colour = texelFetch(row, number); }");
    const std::vector<glm::vec4> texels{{0.25F, 1e-30F, -7.0F, 1e30F}, {1, 2, 3, 4}, {5, 6, 7, 8}};
    const gl::TextureFormat format = gl::texture_format(PixelFormat::rgba32f);
    gl::Texture row = gl::Texture::from_row(gl(), std::as_bytes(std::span(texels)), format, "a row");
    EXPECT_EQ(row.extent(), (gl::Extent{3, 1, 1}));
    EXPECT_EQ(row.bytes(), 48U);
    const gl::Sampler sampler(gl(), {.filter = gl::Filter::nearest});
    const auto fetched = [&](int number) {
        program.use();
        program.bind("row", row, sampler);
        program.set("number", number);
        return pixel(program);
    };
    EXPECT_EQ(fetched(0), texels[0]);
    EXPECT_EQ(fetched(2), texels[2]);
    row.upload_region({1, 0, 0}, {1, 1, 1}, std::as_bytes(std::span(texels).first(1)));
    EXPECT_EQ(fetched(1), texels[0]);
    const auto error = error_of([&] { (void)gl::Texture::from_row(gl(), {}, format, "an empty row"); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::limit);
    EXPECT_EQ(error->where(), "an empty row");
}

TEST_P(ProgramTest, TooManyTexturesAreALimit) {
    const auto error = error_of([&] {
        (void)make(
            "uniform sampler2D maps[16];\nvoid main() { colour = vec4(0.0);"
            " for (int i = 0; i < 1; ++i) colour += texture(maps[0], vec2(0.5)) + texture(maps[15], "
            "vec2(0.5)); }");
    });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::limit);
}

INSTANTIATE_TEST_SUITE_P(Backends, ProgramTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

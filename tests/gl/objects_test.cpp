#include <cstring>
#include <thread>

#include "engine/gl/buffer.h"
#include "engine/gl/sampler.h"
#include "engine/gl/timer.h"
#include "tests/gl/drawing.h"
#include "tests/gl/gl_test.h"

namespace viscera::test {
namespace {

class BufferTest : public GlTest {
  protected:
    [[nodiscard]] std::vector<int> content(const gl::Buffer& buffer) {
        std::vector<int> values(buffer.bytes() / sizeof(int));
        buffer.bind(GL_COPY_READ_BUFFER);
        gl().GetBufferSubData(GL_COPY_READ_BUFFER, 0, static_cast<GLsizeiptr>(buffer.bytes()), values.data());
        return values;
    }
};

TEST_P(BufferTest, UploadsUpdatesAndGrows) {
    const std::vector<int> four{1, 2, 3, 4};
    gl::Buffer buffer(gl(), std::as_bytes(std::span(four)), gl::BufferUsage::stream);
    EXPECT_EQ(content(buffer), four);
    const std::vector<int> other{5, 6, 7, 8};
    buffer.upload(std::as_bytes(std::span(other)));
    EXPECT_EQ(content(buffer), other);
    const std::vector<int> two{9, 10};
    buffer.update(4, std::as_bytes(std::span(two)));
    EXPECT_EQ(content(buffer), (std::vector<int>{5, 9, 10, 8}));
    buffer.upload(std::as_bytes(std::span(two)));
    EXPECT_EQ(content(buffer), two);
    EXPECT_EQ(buffer.bytes(), 8U);
}

TEST_P(BufferTest, RefusesWritesOutside) {
    gl::Buffer buffer(gl(), std::size_t{8}, gl::BufferUsage::dynamic);
    const std::array<std::byte, 5> bytes{};
    EXPECT_TRUE(error_of([&] { buffer.update(4, bytes); }));
    EXPECT_TRUE(error_of([&] { buffer.update(static_cast<std::size_t>(-1), bytes); }));
    EXPECT_FALSE(error_of([&] { buffer.update(3, bytes); }));
}

TEST_P(BufferTest, EditingLeavesTheVertexArrayAlone) {
    gl::VertexArray vertices(gl());
    const gl::Buffer indices(gl(), std::size_t{12}, gl::BufferUsage::fixed);
    vertices.set_indices(indices);
    gl::Buffer other(gl(), std::size_t{4}, gl::BufferUsage::dynamic);
    const std::array<std::byte, 4> bytes{};
    other.update(0, bytes);
    GLint bound = 0;
    gl().GetIntegerv(GL_ELEMENT_ARRAY_BUFFER_BINDING, &bound);
    EXPECT_EQ(static_cast<GLuint>(bound), indices.id());
}

INSTANTIATE_TEST_SUITE_P(Backends, BufferTest, each_backend(), backend_name);

class SamplerTest : public GlTest {
  protected:
    /// The texture {1, 3} of 2 x 1 texels, sampled at u.
    [[nodiscard]] float sample(const gl::SamplerDesc& desc, float u) {
        Image image = make_image(2, 1, PixelFormat::r32f);
        image.set(0, 0, 0, 1.0F);
        image.set(1, 0, 0, 3.0F);
        const gl::Texture texture = gl::Texture::from_image(gl(), image, "two texels");
        const gl::Program program(
            gl(), full_screen(),
            shader("#version 330 core\nuniform sampler2D map; uniform float u; out vec4 colour;\n"
                   "void main() { colour = texture(map, vec2(u, 0.5)); }\n"),
            "sampler");
        const gl::VertexArray vertices(gl());
        const gl::Sampler sampler(gl(), desc);
        const Canvas canvas(gl(), 1, 1);
        program.use();
        program.set("u", u);
        program.bind("map", texture, sampler);
        vertices.bind();
        gl().DrawArrays(GL_TRIANGLES, 0, 3);
        return canvas.read(gl()).at(0, 0, 0);
    }
};

TEST_P(SamplerTest, FiltersAndWraps) {
    using enum gl::Filter;
    using enum gl::Wrap;
    EXPECT_EQ(sample({.filter = nearest}, 0.4F), 1.0F);
    EXPECT_EQ(sample({.filter = linear}, 0.5F), 2.0F);
    EXPECT_EQ(sample({.filter = linear, .wrap = clamp}, 2.0F), 3.0F);
    EXPECT_EQ(sample({.filter = nearest, .wrap = repeat}, 1.25F), 1.0F);
    EXPECT_EQ(sample({.filter = nearest, .wrap = border, .border = {7.0F, 0, 0, 0}}, 1.25F), 7.0F);
}

INSTANTIATE_TEST_SUITE_P(Backends, SamplerTest, each_backend(), backend_name);

using TimerTest = GlTest;

TEST_P(TimerTest, ResultsComeLaterAndNeverWait) {
    gl::GpuTimer timer(gl());
    EXPECT_FALSE(timer.latest_ms());
    for (int i = 0; i < 20; ++i) {  // more than the ring holds
        timer.begin();
        timer.end();
    }
    gl().Finish();
    const std::optional<double> time_ms = timer.latest_ms();
    ASSERT_TRUE(time_ms);
    EXPECT_GE(*time_ms, 0.0);
    EXPECT_EQ(timer.latest_ms(), time_ms);
}

TEST_P(TimerTest, NestsInAQueryOfTheHosts) {
    GLuint query = 0;
    gl().GenQueries(1, &query);
    gl().BeginQuery(GL_TIME_ELAPSED, query);
    gl::GpuTimer timer(gl());
    timer.begin();
    timer.end();
    gl().EndQuery(GL_TIME_ELAPSED);
    gl().DeleteQueries(1, &query);
}

TEST_P(TimerTest, TheClockOfTheCpuRuns) {
    const gl::CpuTimer timer;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    EXPECT_GE(timer.milliseconds(), 2.0);
}

INSTANTIATE_TEST_SUITE_P(Backends, TimerTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

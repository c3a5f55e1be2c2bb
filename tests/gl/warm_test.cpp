#include "engine/gl/host_state.h"
#include "engine/gl/mesh.h"
#include "engine/gl/timer.h"
#include "tests/core/allocation_counter.h"
#include "tests/gl/drawing.h"
#include "tests/gl/gl_test.h"

namespace viscera::test {
namespace {

using WarmTest = GlTest;

TEST_P(WarmTest, AFrameAllocatesNothing) {
    MeshData data;
    data.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}};
    data.indices = {0, 1, 2};
    data.scalars = {{"density", {0, 0, 0}}};
    gl::Mesh mesh(gl(), data);
    const gl::Program program(
        gl(),
        shader("#version 330 core\nin vec3 a_position; in float a_scalar; uniform mat4 view;\n"
               "out float v; void main() { v = a_scalar; gl_Position = view * vec4(a_position, 1.0); }\n"),
        shader("#version 330 core\nin float v; uniform sampler2D map; uniform float values[4];\n"
               "out vec4 colour; void main() { colour = texture(map, vec2(v)) * values[2]; }\n"),
        "warm");
    const gl::Texture map = gl::Texture::make_2d(gl(), 4, 4, PixelFormat::r16f, "map");
    const gl::Sampler sampler(gl(), {});
    const Canvas canvas(gl(), 8, 8);
    gl::GpuTimer timer(gl());
    gl::HostState host(gl());
    const auto frame = [&](float time_s) {
        const gl::HostStateScope scope(host, log());
        timer.begin();
        canvas.begin(gl(), gl::max_blend_state);
        program.use();
        program.set("view", glm::mat4(1.0F));
        program.set("values", std::array{time_s, time_s, time_s, time_s});
        program.set("a name that no shader has and that is too long for a short string", 1);
        program.bind("map", map, sampler);
        mesh.update_scalars("density", std::array{time_s, time_s, time_s});
        mesh.update_indices(std::array{2U, 0U, 1U});
        mesh.draw();
        timer.end();
        (void)timer.latest_ms();
    };
    frame(0.0F);
    gl().Finish();
    const std::size_t before = allocation_count();
    frame(1.0F);
    EXPECT_EQ(allocation_count() - before, 0U);
    gl().Finish();
}

INSTANTIATE_TEST_SUITE_P(Backends, WarmTest, each_backend(), backend_name);

}  // namespace
}  // namespace viscera::test

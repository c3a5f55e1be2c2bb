#include "samples/viscera/bench/shader_pass.h"

#include <array>

#include "engine/gl/sampler.h"
#include "engine/runtime/embedded_shaders.h"
#include "engine/runtime/pass.h"
#include "samples/viscera/bench/other_shader.h"

namespace viscera::app {

std::span<const EmbeddedShader> bench_shader_table();

namespace {

constexpr std::array<const char*, 5> input_names{"a", "b", "c", "d", "e"};
constexpr std::array<const char*, 5> uniform_names{"u_a", "u_b", "u_c", "u_d", "u_e"};

/// One program over the whole target, or triangles that its vertex shader makes.
struct ShaderPassDesc {
    std::vector<ProgramDesc> programs;  ///< one, or none: then the pass only clears
    std::size_t inputs = 0;
    gl::Filter filter = gl::Filter::nearest;
    bool triangles = false;
};

/// A pass that is never cached.
class ShaderPass final : public Effect {
  public:
    explicit ShaderPass(ShaderPassDesc desc) : desc_(std::move(desc)) {}

    void visit(ParamVisitor& v) override {
        v.field({.name = "amount", .doc = "Phase of a source, number of triangles.", .min = 0.0}, amount_);
    }
    std::vector<Port> ports() const override {
        std::vector<Port> ports{{.name = "out",
                                 .access = Access::write,
                                 .target = "out",
                                 .doc = "What is drawn.",
                                 .overwrites = !desc_.programs.empty() && !desc_.triangles}};
        for (std::size_t i = 0; i < desc_.inputs; ++i) {
            ports.push_back({.name = input_names[i],
                             .access = Access::read,
                             .target = input_names[i],
                             .doc = "An input."});
        }
        return ports;
    }
    std::span<const ProgramDesc> programs() const override { return desc_.programs; }
    Work prepare(Prepare&) override { return Work::all(0); }
    void draw(const Pass& pass) override {
        if (desc_.programs.empty()) {
            return;
        }
        const gl::Program& program = pass.use(0);
        program.set("u_amount", static_cast<float>(amount_));
        program.set("u_target_size", glm::vec2(pass.size()));
        for (std::size_t i = 0; i < desc_.inputs; ++i) {
            pass.bind(program, uniform_names[i], input_names[i], desc_.filter);
        }
        if (desc_.triangles) {
            pass.draw_generated(GL_TRIANGLES, 3 * static_cast<int>(amount_), 1);
        } else {
            pass.draw_fullscreen();
        }
    }

  private:
    ShaderPassDesc desc_;
    double amount_ = 0.0;
};

ProgramDesc fullscreen(const char* fragment, std::vector<std::string> defines = {}) {
    return {"common/fullscreen.vert", fragment, std::move(defines)};
}

}  // namespace

void register_bench_effects(Registry& registry) {
    const auto add = [&](std::string name, ShaderPassDesc desc) {
        registry.add(std::move(name), "Measured by the bench.",
                     [desc = std::move(desc)] { return std::make_unique<ShaderPass>(desc); });
    };
    add("bench.clear", {});
    add("bench.source", {.programs = {fullscreen("bench/source.frag")}});
    for (std::size_t inputs = 1; inputs <= input_names.size(); ++inputs) {
        add("bench.copy" + std::to_string(inputs),
            {.programs = {fullscreen("bench/copy.frag", {"INPUTS " + std::to_string(inputs)})},
             .inputs = inputs});
    }
    add("bench.nearest", {.programs = {fullscreen("bench/rate.frag")}, .inputs = 1});
    add("bench.linear",
        {.programs = {fullscreen("bench/rate.frag")}, .inputs = 1, .filter = gl::Filter::linear});
    add("bench.exp", {.programs = {fullscreen("bench/rate.frag", {"EXP"})}});
    add("bench.opacity", {.programs = {fullscreen("bench/opacity.frag")}});
    add("bench.opacity_loop", {.programs = {fullscreen("bench/opacity.frag", {"LOOP"})}});
    add("bench.triangles",
        {.programs = {{"bench/triangles.vert", "bench/white.frag", {}}}, .triangles = true});
    add("bench.vertices",
        {.programs = {{"bench/triangles.vert", "bench/white.frag", {"HIDDEN"}}}, .triangles = true});
    register_other_shaders(registry);
}

ShaderReader bench_shaders() {
    return embedded_shader_reader(bench_shader_table());
}

}  // namespace viscera::app

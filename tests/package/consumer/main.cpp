// A project outside viscera's tree: an effect of its own with a shader of its own, beside viscera's effects.
#include <cstdio>
#include <exception>
#include <memory>
#include <vector>

#include "effects/register_all.h"
#include "engine/context/context.h"
#include "engine/core/scene.h"
#include "engine/gl/program.h"
#include "engine/runtime/embedded_shaders.h"
#include "engine/runtime/pass.h"
#include "engine/runtime/renderer.h"

namespace consumer {

/// Made by viscera_embed_shaders().
std::span<const viscera::EmbeddedShader> shader_table();

namespace {

class StripesEffect final : public viscera::Effect {
  public:
    void visit(viscera::ParamVisitor& v) override {
        v.field({.name = "level", .doc = "Of every other column.", .min = 0.0, .max = 1.0}, level_);
    }
    std::vector<viscera::Port> ports() const override {
        return {{.name = "stripes",
                 .access = viscera::Access::write,
                 .target = "example.stripes",
                 .doc = "Stripes.",
                 .overwrites = true}};
    }
    std::span<const viscera::ProgramDesc> programs() const override { return programs_; }
    viscera::Work prepare(viscera::Prepare& prepare) override {
        return viscera::Work::all(prepare.parameters_key());
    }
    void draw(const viscera::Pass& pass) override {
        pass.use(0).set("u_level", static_cast<float>(level_));
        pass.draw_fullscreen();
    }

  private:
    double level_ = 1.0;
    std::vector<viscera::ProgramDesc> programs_{{"common/fullscreen.vert", "example/stripes.frag", {}}};
};

constexpr const char* scene = R"json({
  "version": 1, "resolution": [16, 8],
  "camera": {"kind": "orthographic", "eye_mm": [0, -10, 0], "target_mm": [0, 0, 0], "up": [0, 0, 1], "height_mm": 10},
  "passes": [
    {"name": "stripes", "effect": "example.stripes", "parameters": {"level": 0.5}},
    {"name": "composite", "effect": "contrast.composite", "targets": {"background": "example.stripes"}}
  ],
  "outputs": ["final"]
})json";

int run() {
    viscera::Registry registry;
    viscera::register_all(registry);
    registry.add("example.stripes", "Stripes.", [] { return std::make_unique<StripesEffect>(); });

    std::vector<viscera::Refusal> refusals;
    const auto context = viscera::create_first_context(viscera::parse_backends("auto"), {}, refusals);
    viscera::Renderer renderer(context->proc_address(), registry,
                               {.shaders = viscera::embedded_shader_reader(shader_table())});
    renderer.set_scene(viscera::parse_scene(scene, "scene.json"));
    renderer.render(renderer.still(0.0));
    const viscera::Image picture = renderer.read("final");
    std::printf("%s: %d x %d, %g %g\n", renderer.context_info().renderer.c_str(), picture.width,
                picture.height, static_cast<double>(picture.at(6, 3, 0)),
                static_cast<double>(picture.at(7, 3, 0)));
    const bool right = picture.width == 16 && picture.at(6, 3, 0) == 0.5F && picture.at(7, 3, 0) == 0.0F;
    return right ? 0 : 1;
}

}  // namespace
}  // namespace consumer

int main() {
    try {
        return consumer::run();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}

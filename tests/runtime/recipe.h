#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/runtime/effect.h"
#include "engine/runtime/embedded_shaders.h"
#include "engine/runtime/pass.h"

namespace viscera::test {

/// An effect in a few words: ports, and what to do with its one parameter `value`.
struct Recipe {
    std::vector<Port> ports;
    std::function<Work(Prepare&, double value)> prepare = [](Prepare&, double) { return Work::all(0); };
    std::function<void(const Pass&, double value)> draw;
};

// Programs of every recipe, by index.
enum RecipeProgram : std::size_t { fill, add, two };

class RecipeEffect final : public Effect {
  public:
    explicit RecipeEffect(Recipe recipe)
        : recipe_(std::move(recipe)),
          programs_{{"common/fullscreen.vert", "test/fill.frag", {}},
                    {"common/fullscreen.vert", "test/add.frag", {}},
                    {"common/fullscreen.vert", "test/two.frag", {}}} {}

    void visit(ParamVisitor& v) override { v.field({.name = "value", .doc = "A number."}, value_); }
    std::vector<Port> ports() const override { return recipe_.ports; }
    std::span<const ProgramDesc> programs() const override { return programs_; }
    Work prepare(Prepare& prepare) override { return recipe_.prepare(prepare, value_); }
    void draw(const Pass& pass) override { recipe_.draw(pass, value_); }

  private:
    Recipe recipe_;
    double value_ = 1.0;
    std::vector<ProgramDesc> programs_;
};

/// Files by name, before those of viscera.
using ShaderFiles = std::map<std::string, std::string, std::less<>>;

inline ShaderFiles recipe_shaders() {
    return {{"test/fill.frag",
             "#version 330 core\nuniform float u_value;\nlayout(location = 0) out vec4 o_value;\n"
             "void main() { o_value = vec4(u_value); }\n"},
            {"test/add.frag",
             "#version 330 core\nuniform sampler2D u_source;\nuniform float u_value;\n"
             "layout(location = 0) out vec4 o_value;\n"
             "void main() { o_value = texelFetch(u_source, ivec2(gl_FragCoord.xy), 0) + u_value; }\n"},
            {"test/two.frag",
             "#version 330 core\nuniform float u_value;\nlayout(location = 0) out vec4 o_first;\n"
             "layout(location = 1) out vec4 o_second;\n"
             "void main() { o_first = vec4(u_value); o_second = vec4(2.0 * u_value); }\n"}};
}

inline ShaderReader reader_of(ShaderFiles files) {
    return [files = std::move(files)](std::string_view name) -> std::optional<std::string> {
        const auto found = files.find(name);
        return found == files.end() ? embedded_shader(name) : std::optional(found->second);
    };
}

inline Port read_port(std::string name = "in", std::string target = "x") {
    return {.name = std::move(name), .access = Access::read, .target = std::move(target), .doc = "Read."};
}
inline Port previous_port(std::string target = "x") {
    return {.name = "last", .access = Access::previous, .target = std::move(target), .doc = "Last."};
}
inline Port write_port(std::string name = "out", std::string target = "x", float clear = 0.0F) {
    return {.name = std::move(name),
            .access = Access::write,
            .target = std::move(target),
            .doc = "Written.",
            .format = PixelFormat::r32f,
            .clear = {clear, 0.0F, 0.0F, 0.0F}};
}
inline Port modify_port(std::string target = "x") {
    return {.name = "on", .access = Access::modify, .target = std::move(target), .doc = "Drawn into."};
}

inline void draw_fill(const Pass& pass, double value) {
    pass.use(fill).set("u_value", static_cast<float>(value));
    pass.draw_fullscreen();
}
inline void draw_two(const Pass& pass, double value) {
    pass.use(two).set("u_value", static_cast<float>(value));
    pass.draw_fullscreen();
}
/// Adds `value` to what `port` holds.
inline std::function<void(const Pass&, double)> draw_add(std::string port) {
    return [port = std::move(port)](const Pass& pass, double value) {
        const gl::Program& program = pass.use(add);
        pass.bind(program, "u_source", port);
        program.set("u_value", static_cast<float>(value));
        pass.draw_fullscreen();
    };
}

/// Cached while the parameter stays as it is.
inline Work prepare_cached(Prepare& prepare, double) {
    return Work::all(prepare.parameters_key());
}

}  // namespace viscera::test

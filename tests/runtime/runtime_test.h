#pragma once

#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/core/scene.h"
#include "engine/runtime/renderer.h"
#include "tests/gl/gl_test.h"
#include "tests/runtime/recipe.h"

namespace viscera::test {

/// A pass of a test scene.
struct ScenePassText {
    std::string effect;
    double value = 1.0;
    std::map<std::string, std::string> targets{};
    bool enabled = true;
};

[[nodiscard]] inline Scene make_scene(const std::vector<ScenePassText>& passes,
                                      const std::vector<std::string>& outputs, int width = 8,
                                      int height = 4) {
    nlohmann::json document{
        {"version", 1}, {"name", "test"}, {"resolution", {width, height}}, {"outputs", outputs}};
    for (const ScenePassText& pass : passes) {
        nlohmann::json node{{"name", "p" + std::to_string(document["passes"].size())},
                            {"effect", pass.effect},
                            {"enabled", pass.enabled},
                            {"parameters", {{"value", pass.value}}}};
        for (const auto& [port, target] : pass.targets) {
            node["targets"][port] = target;
        }
        document["passes"].push_back(std::move(node));
    }
    return parse_scene(document.dump(), "test.json");
}

/// A renderer of recipes in a context of each software backend in turn. Complaints of the renderer or of the
/// driver fail the test.
class RuntimeTest : public GlTest {
  protected:
    void add(const std::string& name, Recipe recipe) {
        add_effect(name, [recipe] { return std::make_unique<RecipeEffect>(recipe); });
    }
    void add_effect(const std::string& name, Registry::Factory make) {
        registry_.add(name, "A recipe.", std::move(make));
    }
    Renderer& renderer() {
        if (!renderer_) {
            renderer_.emplace(
                proc_ != nullptr ? proc_ : context().proc_address(), registry_,
                RendererOptions{
                    .log = [this](LogLevel level, std::string_view text) { log().write(level, text); },
                    .shaders = reader_of(shaders_)});
        }
        return *renderer_;
    }
    void TearDown() override {
        renderer_.reset();
        GlTest::TearDown();
    }

    /// The one value that every pixel of a target has.
    float value_of(std::string_view target) {
        const Image image = renderer().read(target);
        const float first = image.at(0, 0, 0);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                EXPECT_EQ(image.at(x, y, 0), first) << target << " at " << x << "," << y;
            }
        }
        return first;
    }
    const FrameReport& render(std::uint64_t index) { return renderer().render(renderer().frame(index)); }
    [[nodiscard]] static PassStatus status(const FrameReport& report, std::size_t pass) {
        return report.passes.at(pass).status;
    }

    ShaderFiles shaders_ = recipe_shaders();
    ProcAddress proc_ = nullptr;  ///< in place of the context's

  private:
    Registry registry_;
    std::optional<Renderer> renderer_;
};

}  // namespace viscera::test

#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "effects/register_all.h"
#include "engine/context/context.h"
#include "engine/core/error.h"
#include "engine/runtime/renderer.h"

namespace viscera::test {

/// A renderer with every effect in an offscreen context of its own, and what it complained of.
class Stage {
  public:
    /// watched: what stands in for the context's functions, such as a recorder's.
    explicit Stage(Backend backend = Backend::osmesa, ShaderReader shaders = {},
                   ComputeUse compute = ComputeUse::automatic,
                   BackgroundFill background = BackgroundFill::automatic,
                   const std::function<ProcAddress(ProcAddress)>& watched = {})
        : context_(create_context(backend, {.debug = true})) {
        register_all(registry_);
        RendererOptions options;
        options.log = [this](LogLevel level, std::string_view message) {
            if (level == LogLevel::error || level == LogLevel::warning) {
                complaints_.emplace_back(message);
            }
        };
        options.shaders = std::move(shaders);
        options.compute = compute;
        options.background = background;
        const ProcAddress proc = context_->proc_address();
        renderer_ = std::make_unique<Renderer>(watched ? watched(proc) : proc, registry_, std::move(options));
    }

    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;
    /// Stages may live side by side; each must be current for its end, too.
    ~Stage() { context_->make_current(); }

    void make_current() { context_->make_current(); }
    [[nodiscard]] Renderer& renderer() { return *renderer_; }
    [[nodiscard]] const Context& context() const { return *context_; }
    [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }

    /// Takes a scene given as JSON. Paths stand against assets/scenes, as those of the scenes there do.
    void load(const nlohmann::json& scene) {
        const auto file = std::filesystem::path(VISCERA_SOURCE_DIR) / "assets" / "scenes" / "test.json";
        renderer_->set_scene(parse_scene(scene.dump(), file));
    }

    /// Renders and reads one target.
    [[nodiscard]] Image shot(std::string_view target, double time_s, const HostValues* values = nullptr) {
        renderer_->keep({std::string(target)});
        render(time_s, values);
        return renderer_->read(target);
    }
    const FrameReport& render(double time_s, const HostValues* values = nullptr) {
        Frame frame = renderer_->still(time_s);
        frame.values = values;
        return renderer_->render(frame);
    }

  private:
    std::vector<std::string> complaints_;
    std::unique_ptr<Context> context_;
    Registry registry_;
    std::unique_ptr<Renderer> renderer_;
};

/// What a pass did in a frame; a report without the pass gives an empty name.
inline PassReport pass_of(const FrameReport& report, std::string_view name) {
    const auto found = std::ranges::find(report.passes, name, &PassReport::name);
    return found == report.passes.end() ? PassReport{} : *found;
}

}  // namespace viscera::test

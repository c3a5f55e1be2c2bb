#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/context/context.h"
#include "engine/gl/capabilities.h"
#include "engine/gl/timer.h"
#include "engine/runtime/renderer.h"
#include "samples/viscera/bench/samples.h"

namespace viscera::app {

/// One line of the result: a time, an error, and what the time is held against.
struct Row {
    std::string group;  ///< name of the case
    std::string name;
    Samples samples;
    std::optional<double> error;  ///< largest absolute difference
    std::optional<double> rms;    ///< root of the mean squared difference
    std::string error_of;         ///< against what
    std::optional<double> value;  ///< a rate or another figure
    std::string unit;             ///< of `value`
    std::string ceiling;          ///< what `base` is
    Samples base;
    std::optional<double> goal;  ///< of the ratio
};

/// What all cases share: the context, the sizes, and the rows found so far.
class Lab {
  public:
    struct Options {
        std::filesystem::path assets;
        int width = 1024;
        int height = 1024;
        int repeats = 20;
        LogCallback log;
        ComputeUse compute = ComputeUse::automatic;
        std::filesystem::path glsl;  ///< shaders there come before those in the binary; empty: none do
    };
    Lab(Context& context, Options options);

    [[nodiscard]] const gl::Functions& gl() const { return *gl_; }
    [[nodiscard]] const gl::Capabilities& capabilities() const { return capabilities_; }
    [[nodiscard]] const Options& options() const { return options_; }
    [[nodiscard]] const Registry& registry() const { return registry_; }
    [[nodiscard]] ProcAddress proc() const { return context_.proc_address(); }
    [[nodiscard]] ShaderReader shaders() const;
    /// Times come from the GPU's clock; otherwise from the wall's, with glFinish.
    [[nodiscard]] bool hardware() const { return capabilities_.gpu_timers(); }

    /// Whether passes are to be measured as compute shaders, too.
    [[nodiscard]] bool by_compute() const {
        return capabilities_.compute &&
               (options_.compute == ComputeUse::on ||
                (options_.compute == ComputeUse::automatic && !capabilities_.software));
    }

    /// One of assets/scenes as JSON, in the bench's resolution.
    [[nodiscard]] nlohmann::json scene(std::string_view name) const;
    /// The default one.
    [[nodiscard]] nlohmann::json default_scene() const { return scene("angiography.json"); }
    /// Frame and `shared` of the default scene, without passes.
    [[nodiscard]] nlohmann::json empty_scene() const;

    void add(Row row);
    [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }

  private:
    Context& context_;
    Options options_;
    std::unique_ptr<const gl::Functions> gl_;
    gl::Capabilities capabilities_;
    Registry registry_;
    std::vector<Row> rows_;
};

/// A scene under measurement. Its time moves on a little with each frame, so that nothing is cached.
class Stage {
  public:
    struct Options {
        ShaderReader shaders;         ///< empty: the bench's
        bool by_pass = true;          ///< measures each pass; this makes software renderers wait after each
        bool calling_thread = false;  ///< measures that thread's processor time alone, without waiting
        double time_s = 1.5;          ///< of the first frame
        double step_s = 1.0 / 512;    ///< 0: a still
        int repeats = 0;              ///< 0: as the lab's
        HostStatePolicy host_state = HostStatePolicy::host_resets;
        std::optional<int> warm;            ///< frames before the measured ones; none: as many as it takes
        std::optional<ComputeUse> compute;  ///< in place of the lab's
    };
    Stage(Lab& lab, const nlohmann::json& scene) : Stage(lab, scene, Options()) {}
    Stage(Lab& lab, const nlohmann::json& scene, Options options);
    Stage(Lab& lab, Scene scene, Options options);

    using Edit = std::function<void(Frame&)>;
    /// Warm frames, then the measured ones.
    void run(const Edit& edit = {});

    [[nodiscard]] const Samples& pass(const std::string& name) const { return passes_.at(name); }
    /// Empty when the pass was never drawn.
    [[nodiscard]] Samples pass_or_none(const std::string& name) const {
        return passes_.contains(name) ? passes_.at(name) : Samples();
    }
    [[nodiscard]] const Samples& whole() const { return whole_; }
    [[nodiscard]] Renderer& renderer() { return *renderer_; }
    [[nodiscard]] Image read(std::string_view target) { return renderer_->read(target); }
    /// Renders one more frame at a time and reads a target.
    [[nodiscard]] Image shot(std::string_view target, double time_s);
    [[nodiscard]] const FrameReport& report() const { return report_; }

  private:
    void frame(const Edit& edit, bool measured);
    void observe(std::string_view pass, bool begins);
    void wait() const;
    [[nodiscard]] Sample now() const;
    [[nodiscard]] bool gpu_clock() const { return lab_.hardware() && !options_.calling_thread; }

    Lab& lab_;
    Options options_;
    std::unique_ptr<Renderer> renderer_;
    FrameReport report_;
    Samples whole_;
    std::map<std::string, Samples> passes_;
    std::map<std::string, std::unique_ptr<gl::GpuTimer>, std::less<>> timers_;
    std::unique_ptr<gl::GpuTimer> whole_timer_;
    std::vector<std::string> drawn_;
    Sample start_;
    bool measured_ = false;
    std::uint64_t index_ = 0;
};

/// Largest absolute difference over all pixels and channels; infinity for sizes that differ or NaN.
[[nodiscard]] double largest_difference(const Image& a, const Image& b);

}  // namespace viscera::app

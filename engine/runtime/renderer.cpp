#include "engine/runtime/renderer.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "engine/gl/capabilities.h"
#include "engine/gl/debug.h"
#include "engine/gl/host_state.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/runtime/capture.h"
#include "engine/runtime/embedded_shaders.h"
#include "engine/runtime/executor.h"
#include "engine/runtime/eye_scene.h"
#include "engine/runtime/presenter.h"
#include "engine/runtime/scene_graph.h"
#include "engine/runtime/target_watch.h"
#include "engine/runtime/timeline_values.h"

namespace viscera {
namespace {

/// One black texel for inputs that are empty.
gl::Texture make_black(const gl::Functions& gl) {
    gl::Texture black = gl::Texture::make_2d(gl, 1, 1, PixelFormat::rgba8, "black");
    const std::array<std::byte, 4> texel{};
    black.upload(texel);
    return black;
}

bool same(const ImportedTarget& a, const ImportedTexture& b) {
    return a.name == b.target && a.format == b.format && a.width == b.width && a.height == b.height &&
           a.writable == b.writable;
}

/// Whether two effects take the same place in a graph.
bool same_place(const Port& a, const Port& b) {
    return a.name == b.name && a.access == b.access && a.target == b.target && a.format == b.format &&
           a.size.scale == b.size.scale && a.size.width == b.size.width && a.size.height == b.size.height &&
           a.clear == b.clear && a.optional == b.optional && a.passthrough == b.passthrough &&
           a.overwrites == b.overwrites;
}

/// Of the frames that a scene is made for: two when it says so itself, or when the host brings something per
/// eye.
int eyes_of(const Scene& scene, std::span<const ImportedTarget> imported) {
    const bool per_eye = std::ranges::any_of(
        imported, [](const ImportedTarget& target) { return target.name.ends_with(".right"); });
    return scene.camera.stereo || per_eye ? 2 : 1;
}

bool reads_history(const SceneEffects& scene) {
    return std::ranges::any_of(scene.effects, [](const std::unique_ptr<Effect>& effect) {
        const std::vector<Port> ports = effect->ports();
        return std::ranges::find(ports, Access::previous, &Port::access) != ports.end();
    });
}

ContextInfo describe(const gl::Capabilities& capabilities) {
    ContextInfo info;
    info.vendor = capabilities.vendor;
    info.renderer = capabilities.renderer;
    info.version = capabilities.version;
    info.major = capabilities.major;
    info.minor = capabilities.minor;
    info.software = capabilities.software;
    return info;
}

bool uses_compute(ComputeUse wanted, const gl::Capabilities& capabilities, Log& log) {
    if (wanted == ComputeUse::on && !capabilities.compute) {
        log.info("compute shaders are wanted but need OpenGL 4.3, the context is " + capabilities.version +
                 "; fragment shaders are used");
    }
    return capabilities.compute &&
           (wanted == ComputeUse::on || (wanted == ComputeUse::automatic && !capabilities.software));
}

}  // namespace

/// Members are destroyed in reverse order: all that holds OpenGL objects before the functions that delete
/// them.
class Renderer::Impl {
  public:
    Impl(ProcAddress proc, const Registry& registry, RendererOptions options)
        : log_(options.log),
          registry_(registry),
          gl_(gl::Functions::load(proc)),
          capabilities_(gl::Capabilities::query(*gl_)),
          info_(describe(capabilities_)),
          host_state_(*gl_),
          entry_(host_state_, log_),
          assets_(log_, std::move(options.progress), std::move(options.cache_folder)),
          shaders_(*gl_, options.shaders ? options.shaders : embedded_shader_reader(), log_),
          samplers_(*gl_),
          black_(make_black(*gl_)),
          no_vertices_(*gl_),
          shared_{*gl_,         shaders_, samplers_, black_,
                  no_vertices_, assets_,  log_,      uses_compute(options.compute, capabilities_, log_)},
          executor_(
              shared_, capabilities_,
              {.timers = options.timers,
               .check_errors = options.check_errors,
               .observer = std::move(options.observer),
               .fill_after = options.background == BackgroundFill::after ||
                             (options.background == BackgroundFill::automatic && !capabilities_.software)}),
          presenter_(shared_),
          capture_(*gl_),
          watch_(*gl_, watch_path(WatchPath::automatic)) {
        entry_.leave();
    }

    void set_scene(Scene scene, std::span<const ImportedTarget> imported) {
        SceneEffects effects = make_effects(scene, registry_);
        // Compiled once for its faults, so that a scene that cannot run is refused while the old one still
        // can.
        (void)compile_scene(scene, EyeScene(scene, effects, imported, {}, eyes_of(scene, imported)).graph(),
                            scene.width, scene.height, capabilities_.max_texture_2d);
        expected_.assign(imported.begin(), imported.end());
        scene_ = std::move(scene);
        timeline_ = TimelineValues(scene_.timeline);
        effects_ = std::move(effects);
        right_effects_ = {};
        has_history_ = reads_history(effects_);
        assets_.begin_scene();
        planned_ = same_scene_ = false;
        watch_.forget();
    }

    void set_parameter(std::string_view pass, std::string_view pointer, const nlohmann::json& value) {
        const auto found = std::ranges::find(scene_.passes, pass, &ScenePass::name);
        if (found == scene_.passes.end()) {
            throw Error(ErrorCode::scene, std::string(pass), "the scene has no pass of this name");
        }
        Scene changed = scene_;
        const auto index = static_cast<std::size_t>(found - scene_.passes.begin());
        ScenePass& target = changed.passes[index];
        try {
            target.parameters[nlohmann::json::json_pointer(std::string(pointer))] = value;
        } catch (const nlohmann::json::exception&) {
            throw Error(ErrorCode::scene, std::string(pass),
                        "'" + std::string(pointer) + "' leads to no parameter");
        }
        SceneEffects effects = make_effects(changed, registry_);
        if (!planned_ || effects.effects[index]->uses_view() != effects_.effects[index]->uses_view() ||
            !std::ranges::equal(effects.effects[index]->ports(), effects_.effects[index]->ports(),
                                same_place)) {
            const std::vector<ImportedTarget> imported = expected_;
            set_scene(std::move(changed), imported);
            return;
        }
        // The graph is the same, so what other passes have drawn stays.
        const auto take = [&](SceneEffects& made, SceneEffects& into, int eye) {
            executor_.replace_effect({made.effects[index].get(), made.parameter_keys[index], {index, eye}});
            std::swap(into.effects[index], made.effects[index]);
            into.parameter_keys[index] = made.parameter_keys[index];
        };
        if (!right_effects_.effects.empty()) {
            SceneEffects right = make_effects(changed, registry_);
            take(right, right_effects_, 1);
        }
        take(effects, effects_, 0);
        scene_ = std::move(changed);
        assets_.begin_scene();
    }

    const FrameReport& render(const Frame& frame) {
        const gl::CpuTimer timer;
        if (frame.width < 1 || frame.height < 1) {
            throw Error(ErrorCode::usage, "frame", "needs a width and a height of at least 1 pixel");
        }
        if (frame.eye_count != 1 && frame.eye_count != 2) {
            throw Error(ErrorCode::usage, "frame", "has one eye or two");
        }
        // Written so that NaN is refused, too.
        if (!(frame.quality.step_factor >= 1.0 && std::isfinite(frame.quality.step_factor)) ||
            !(frame.quality.resolution > 0.0 && frame.quality.resolution <= 1.0)) {
            throw Error(ErrorCode::usage, "frame",
                        "needs a step factor of at least 1 and a resolution in (0, 1]");
        }
        if (scene_.passes.empty()) {
            throw Error(ErrorCode::usage, "frame", "there is no scene to render");
        }
        std::optional<gl::HostStateScope> scope;
        if (frame.host_state == HostStatePolicy::restore) {
            scope.emplace(host_state_, log_);
        } else {
            gl::drain_errors(*gl_);
        }
        std::optional<gl::DebugMessages> messages;
        if (capabilities_.debug_context) {
            messages.emplace(*gl_, log_);
        }
        if (frame.eye_index != 0) {
            throw Error(ErrorCode::usage, "frame", "eye_index is the renderer's own");
        }
        plan_for(frame, planned_size(frame));
        report_.index = frame.index;
        report_.time_s = frame.time_s;
        report_.targets.clear();
        if (frame.values == nullptr && !timeline_.empty()) {
            Frame with_values = frame;
            with_values.values = &timeline_.at(frame.time_s, log_);
            executor_.run(with_values, report_);
        } else {
            watch_.poll();  // what of the last frame has been done by now would lie a frame back afterwards
            executor_.run(frame, report_);
            watch_.frame_done(executor_, frame.index, frame.time_s);
        }
        present(frame);
        report_.cpu_ms = timer.milliseconds();
        if (!dump_names_.empty() && frame.capture) {
            if (capabilities_.software) {
                gl_->Finish();  // for the reason that gl::read_texture has
            }
            capture_.start(report_, dump_names_, executor_);
        }
        return report_;
    }

    int reload(ShaderReader reader) {
        planned_ = false;  // what the old programs drew is not what the new ones would draw
        return shaders_.reload(std::move(reader));
    }

    void set_dump(DumpRequest request, CaptureSink sink) {
        dump_ = std::move(request);
        capture_.set_sink(std::move(sink));
        planned_ = false;
    }

    void watch(std::vector<std::string> targets, WatchPath path) {
        watch_.set_path(watch_path(path));
        watch_.set_targets(targets);
        planned_ = false;
    }

    [[nodiscard]] WatchPath watch_path(WatchPath path) const {
        const WatchPath best = capabilities_.software ? WatchPath::deferred : WatchPath::buffered;
        return path == WatchPath::automatic ? best : path;
    }

    void keep(std::vector<std::string> targets) {
        kept_ = std::move(targets);
        planned_ = false;
    }

    template <class Work>
    auto with_host_state(Work&& work) {
        const gl::HostStateScope scope(host_state_, log_);
        return work();
    }

    Image read(std::string_view target) {
        const std::optional<Executor::Output> output = executor_.output(target);
        if (!output) {
            const std::vector<std::string> names = names_of(target);
            throw Error(ErrorCode::usage, std::string(target),
                        names.size() == 2 ? "is each eye's own: '" + names[0] + "' and '" + names[1] + "'"
                                          : "is no output of the last frame; dump it to have it kept");
        }
        if (output->texture == nullptr) {
            return clear_image(*output->content);
        }
        return with_host_state([&] { return gl::read_texture(*gl_, *output->texture); });
    }

    std::vector<std::string> names_of(std::string_view name) const {
        return eye_scene_ ? eye_scene_->names_of(name) : std::vector{std::string(name)};
    }

    unsigned texture(std::string_view output) const {
        const std::optional<Executor::Output> found = executor_.output(output);
        return found && found->texture != nullptr ? found->texture->id() : 0;
    }

    Log log_;
    const Registry& registry_;
    std::unique_ptr<const gl::Functions> gl_;
    gl::Capabilities capabilities_;
    ContextInfo info_;
    gl::HostState host_state_;
    /// Keeps the host's state while the constructor makes objects.
    struct Entry {
        Entry(gl::HostState& state, Log& log) { scope.emplace(state, log); }
        void leave() { scope.reset(); }
        std::optional<gl::HostStateScope> scope;
    } entry_;
    Assets assets_;
    ShaderLibrary shaders_;
    Samplers samplers_;
    gl::Texture black_;
    gl::VertexArray no_vertices_;
    Pass::Shared shared_;
    Scene scene_;
    TimelineValues timeline_;
    SceneEffects effects_;               ///< of the only or the left eye, and of what both share
    SceneEffects right_effects_;         ///< of the right eye; empty before the first frame of two
    std::optional<EyeScene> eye_scene_;  ///< of the plan
    Executor executor_;
    Presenter presenter_;
    Capture capture_;
    TargetWatch watch_;
    DumpRequest dump_;
    std::vector<std::string> kept_;
    std::vector<std::string> dump_names_;
    std::vector<ImportedTarget> expected_;  ///< as set_scene() was told
    std::vector<ImportedTarget> imported_;  ///< as the last frame brought
    bool planned_ = false;
    bool same_scene_ = false;  ///< as when the last plan was made
    int planned_eyes_ = 1;
    bool has_history_ = false;
    FrameReport report_;

  private:
    /// Targets of the frame before, and those of the host, have a size that no single frame can change.
    [[nodiscard]] glm::ivec2 planned_size(const Frame& frame) const {
        const double share = has_history_ || !frame.imported.empty() ? 1.0 : frame.quality.resolution;
        const auto scaled = [share](int pixels) {
            return std::max(1, static_cast<int>(std::lround(share * pixels)));
        };
        return {scaled(frame.width), scaled(frame.height)};
    }

    void plan_for(const Frame& frame, glm::ivec2 size) {
        const bool same_imports = std::ranges::equal(imported_, frame.imported, same);
        if (planned_ && same_imports && planned_eyes_ == frame.eye_count &&
            executor_.plan().width == size.x && executor_.plan().height == size.y) {
            return;
        }
        planned_ = false;  // until all of the below has worked
        imported_.clear();
        for (const ImportedTexture& texture : frame.imported) {
            imported_.push_back(
                {texture.target, texture.format, texture.width, texture.height, texture.writable});
        }
        if (frame.eye_count == 2 && right_effects_.effects.empty()) {
            right_effects_ = make_effects(scene_, registry_);
        }
        const auto passes_with = [&](const std::vector<std::string>& more) {
            return EyeScene(scene_, effects_, imported_, more, frame.eye_count);
        };
        const auto compile = [&](const EyeScene& passes) {
            return compile_scene(scene_, passes.graph(), size.x, size.y, capabilities_.max_texture_2d);
        };
        std::vector<std::string> dumped;
        switch (dump_.kind) {
            case DumpRequest::Kind::none:
                break;
            case DumpRequest::Kind::outputs:
                dumped = scene_.outputs;
                break;
            case DumpRequest::Kind::names:
                dumped = dump_.names;
                break;
            case DumpRequest::Kind::all:
                dumped = live_targets(compile(passes_with({})));
                break;
        }
        // What is read back is an output: it keeps its texture to the end of the frame.
        std::vector<std::string> more = dumped;
        more.insert(more.end(), kept_.begin(), kept_.end());
        const std::vector<std::string> watched = watch_.targets();
        more.insert(more.end(), watched.begin(), watched.end());
        EyeScene passes = passes_with(more);
        Plan plan = compile(passes);
        dump_names_.clear();
        for (const std::string& name : dumped) {
            for (std::string& one : passes.names_of(name)) {
                dump_names_.push_back(std::move(one));
            }
        }
        eye_scene_.emplace(std::move(passes));
        executor_.set_plan(std::move(plan), imported_, eye_scene_->effects(effects_, right_effects_),
                           same_scene_);
        planned_eyes_ = frame.eye_count;
        planned_ = same_scene_ = true;
    }

    static std::vector<std::string> live_targets(const Plan& plan) {
        std::vector<std::string> names;
        for (const PlanContent& content : plan.contents) {
            if (content.writer && content.texture &&
                std::ranges::find(names, content.target) == names.end()) {
                names.push_back(content.target);
            }
        }
        return names;
    }

    void present(const Frame& frame) {
        const bool apart = frame.eye_count == 2 && frame.present_right.enabled;
        if (frame.present.enabled) {
            show(frame.present, apart ? 0 : -1);
        }
        if (apart) {
            show(frame.present_right, 1);
        }
    }

    /// eye: the one of two that is shown; -1: whatever there is.
    void show(const Present& present, int eye) {
        const std::string& name = present.output.empty() ? scene_.outputs.front() : present.output;
        const auto show_one = [&](const Executor::Output& output, const PixelRect& viewport) {
            presenter_.present(present, viewport, output.texture, *output.content);
        };
        if (const auto own = eye < 0 ? std::nullopt : executor_.output(eye_name(name, eye))) {
            return show_one(*own, present.viewport);
        }
        if (const auto output = executor_.output(name)) {
            return show_one(*output, present.viewport);
        }
        const auto left = executor_.output(eye_name(name, 0));
        const auto right = executor_.output(eye_name(name, 1));
        if (!left || !right) {
            throw Error(ErrorCode::usage, name, "cannot be presented: it is no output of the scene");
        }
        PixelRect half = present.viewport;
        half.width /= 2;
        show_one(*left, half);
        half.x += half.width;
        half.width = present.viewport.width - half.width;
        show_one(*right, half);
    }
};

Renderer::Renderer(ProcAddress proc, const Registry& registry, RendererOptions options)
    : impl_(std::make_unique<Impl>(proc, registry, std::move(options))) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::set_scene(Scene scene, std::span<const ImportedTarget> imported) {
    impl_->with_host_state([&] { impl_->set_scene(std::move(scene), imported); });
}
const Scene& Renderer::scene() const {
    return impl_->scene_;
}
void Renderer::set_parameter(std::string_view pass, std::string_view pointer, const nlohmann::json& value) {
    impl_->with_host_state([&] { impl_->set_parameter(pass, pointer, value); });
}

Frame Renderer::still(double time_s) const {
    const Scene& scene = impl_->scene_;
    Frame frame{.width = scene.width, .height = scene.height, .time_s = time_s};
    frame.look(make_eyes(scene.camera, frame.aspect(), time_s));
    return frame;
}
Frame Renderer::frame(std::uint64_t index) const {
    Frame frame = still(static_cast<double>(index) / impl_->scene_.frames_per_second);
    frame.index = index;
    return frame;
}

bool Renderer::keeps_state() const {
    return impl_->has_history_;
}
const FrameReport& Renderer::render(const Frame& frame) {
    return impl_->render(frame);
}
void Renderer::set_dump(DumpRequest request, CaptureSink sink) {
    impl_->set_dump(std::move(request), std::move(sink));
}
void Renderer::keep(std::vector<std::string> targets) {
    impl_->keep(std::move(targets));
}
void Renderer::watch(std::vector<std::string> targets, WatchPath path) {
    impl_->with_host_state([&] { impl_->watch(std::move(targets), path); });
}
void Renderer::wait_for_watched(std::uint64_t most_frames_behind) {
    impl_->with_host_state([&] { impl_->watch_.wait(most_frames_behind); });
}
const WatchedTarget* Renderer::watched(std::string_view target) {
    impl_->with_host_state([&] { impl_->watch_.poll(); });
    return impl_->watch_.find(target);
}
void Renderer::poll_captures() {
    impl_->with_host_state([&] { impl_->capture_.poll(false); });
}
void Renderer::finish_captures() {
    impl_->with_host_state([&] { impl_->capture_.poll(true); });
}
Image Renderer::read(std::string_view target) {
    return impl_->read(target);
}
std::vector<std::string> Renderer::names_of(std::string_view name) const {
    return impl_->names_of(name);
}
unsigned Renderer::texture(std::string_view output) const {
    return impl_->texture(output);
}
unsigned Renderer::release_texture(std::string_view output) {
    return impl_->with_host_state([&] { return impl_->executor_.release(output); });
}
const Plan& Renderer::plan() const {
    return impl_->executor_.plan();
}
int Renderer::reload_shaders(const std::filesystem::path& glsl_folder) {
    return impl_->with_host_state([&] { return impl_->reload(shader_reader_from_folder(glsl_folder)); });
}
Log& Renderer::log() {
    return impl_->log_;
}
const ContextInfo& Renderer::context_info() const {
    return impl_->info_;
}
std::size_t Renderer::asset_count() const {
    return impl_->assets_.size();
}

}  // namespace viscera

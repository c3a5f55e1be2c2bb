#include "engine/runtime/renderer.h"

#include <nlohmann/json.hpp>

#include "engine/context/context_info.h"
#include "engine/core/error.h"
#include "engine/gl/capabilities.h"
#include "engine/gl/debug.h"
#include "engine/gl/host_state.h"
#include "engine/gl/pixel_transfer.h"
#include "engine/runtime/capture.h"
#include "engine/runtime/embedded_shaders.h"
#include "engine/runtime/executor.h"
#include "engine/runtime/loaded_scene.h"
#include "engine/runtime/presenter.h"
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

/// HARDWARE: a branch that no pixel of a group takes costs nothing. Software renderers run both sides of
/// each.
std::vector<std::string> shader_defines(const gl::Capabilities& capabilities) {
    return capabilities.software ? std::vector<std::string>{} : std::vector<std::string>{"HARDWARE"};
}

bool uses_compute(ComputeUse wanted, const gl::Capabilities& capabilities, const ContextInfo& info,
                  Log& log) {
    if (wanted == ComputeUse::on && !capabilities.compute) {
        log.info("compute shaders are wanted but need OpenGL 4.3, the context is " + info.version +
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
          gl_(gl::Functions::load(proc)),
          capabilities_(gl::Capabilities::query(*gl_)),
          info_(read_context_info(Backend::current, *gl_)),
          host_state_(*gl_),
          entry_(host_state_, log_),
          assets_(log_, std::move(options.progress), std::move(options.cache_folder)),
          shaders_(*gl_, options.shaders ? options.shaders : embedded_shader_reader(),
                   shader_defines(capabilities_), log_),
          samplers_(*gl_),
          black_(make_black(*gl_)),
          no_vertices_(*gl_),
          shared_{
              *gl_,         shaders_, samplers_, black_,
              no_vertices_, assets_,  log_,      uses_compute(options.compute, capabilities_, info_, log_)},
          scene_(registry, capabilities_.max_texture_2d),
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
        scene_.set(std::move(scene), imported);
        timeline_ = TimelineValues(scene_.scene().timeline);
        assets_.begin_scene();
        assets_.forget_files();
        watch_.forget();
    }

    void set_parameter(std::string_view pass, std::string_view pointer, const nlohmann::json& value) {
        LoadedScene::Edited edited = scene_.edited(pass, pointer, value);
        if (scene_.replace(edited, executor_)) {
            assets_.begin_scene();
        } else {
            set_scene(std::move(edited.scene), std::vector(scene_.expected()));
        }
    }

    const FrameReport& render(const Frame& frame) {
        const gl::CpuTimer timer;
        check_current();
        check_frame(frame);
        if (scene_.scene().passes.empty()) {
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
        scene_.plan_for(frame, read_back_, executor_);
        report_.index = frame.index;
        report_.time_s = frame.time_s;
        report_.targets.clear();
        watch_.take();  // what of the last frame has been done by now would lie a frame back afterwards
        if (frame.values == nullptr && !timeline_.empty()) {
            Frame with_values = frame;
            with_values.values = &timeline_.at(frame.time_s, log_);
            executor_.run(with_values, report_);
        } else {
            executor_.run(frame, report_);
        }
        watch_.frame_done(executor_, frame.index, frame.time_s);
        presenter_.present(frame, scene_.scene().outputs.front(), executor_);
        report_.cpu_ms = timer.milliseconds();
        if (!scene_.dumped().empty() && frame.capture) {
            if (capabilities_.software) {
                gl_->Finish();  // for the reason that gl::read_texture has
            }
            capture_.start(report_, scene_.dumped(), executor_);
        }
        return report_;
    }

    int reload(ShaderReader reader) {
        scene_.replan();  // what the old programs drew is not what the new ones would draw
        return shaders_.reload(std::move(reader));
    }

    void set_dump(DumpRequest request, CaptureSink sink) {
        read_back_.dump = std::move(request);
        capture_.set_sink(std::move(sink));
        scene_.replan();
    }

    void watch(const std::vector<std::string>& targets, WatchPath path) {
        watch_.set_path(watch_path(path));
        watch_.set_targets(targets);
        read_back_.watched = watch_.targets();
        scene_.replan();
    }

    [[nodiscard]] WatchPath watch_path(WatchPath path) const {
        const WatchPath best = capabilities_.software ? WatchPath::deferred : WatchPath::buffered;
        return path == WatchPath::automatic ? best : path;
    }

    void keep(std::vector<std::string> targets) {
        read_back_.kept = std::move(targets);
        scene_.replan();
    }

    /// Drivers take calls without a context for no calls at all, so that nothing would be drawn and nobody
    /// told.
    void check_current() const {
        if (gl_->GetString(GL_VERSION) == nullptr) {
            throw Error(ErrorCode::context, "renderer", "no OpenGL context is current on this thread");
        }
    }

    template <class Work>
    auto with_host_state(Work&& work) {
        check_current();
        const gl::HostStateScope scope(host_state_, log_);
        return work();
    }

    Image read(std::string_view target) {
        const std::optional<Executor::Output> output = executor_.output(target);
        if (!output) {
            const std::vector<std::string> names = scene_.names_of(target);
            throw Error(ErrorCode::usage, std::string(target),
                        names.size() == 2 ? "is each eye's own: '" + names[0] + "' and '" + names[1] + "'"
                                          : "is no output of the last frame; dump it to have it kept");
        }
        if (output->texture == nullptr) {
            return clear_image(*output->content);
        }
        return with_host_state([&] { return gl::read_texture(*gl_, *output->texture); });
    }

    unsigned texture(std::string_view output) const {
        const std::optional<Executor::Output> found = executor_.output(output);
        return found && found->texture != nullptr ? found->texture->id() : 0;
    }

    Log log_;
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
    LoadedScene scene_;
    TimelineValues timeline_;
    Executor executor_;
    Presenter presenter_;
    Capture capture_;
    TargetWatch watch_;
    ReadBack read_back_;
    FrameReport report_;
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
    return impl_->scene_.scene();
}
void Renderer::set_parameter(std::string_view pass, std::string_view pointer, const nlohmann::json& value) {
    impl_->with_host_state([&] { impl_->set_parameter(pass, pointer, value); });
}

Frame Renderer::still(double time_s) const {
    const Scene& scene = impl_->scene_.scene();
    Frame frame{.width = scene.width, .height = scene.height, .time_s = time_s};
    frame.look(make_eyes(scene.camera, frame.aspect(), time_s));
    return frame;
}
Frame Renderer::frame(std::uint64_t index) const {
    Frame frame = still(static_cast<double>(index) / impl_->scene_.scene().frames_per_second);
    frame.index = index;
    return frame;
}

bool Renderer::keeps_state() const {
    return impl_->scene_.keeps_state();
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
    impl_->with_host_state([&] { impl_->watch(targets, path); });
}
void Renderer::wait_for_watched(std::uint64_t most_frames_behind) {
    impl_->with_host_state([&] { impl_->watch_.wait(impl_->executor_, most_frames_behind); });
}
const WatchedTarget* Renderer::watched(std::string_view target) {
    impl_->with_host_state([&] { impl_->watch_.poll(impl_->executor_); });
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
    return impl_->scene_.names_of(name);
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

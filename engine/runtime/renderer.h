#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/context/context.h"
#include "engine/core/image.h"
#include "engine/core/log.h"
#include "engine/core/plan.h"
#include "engine/core/progress.h"
#include "engine/core/scene.h"
#include "engine/core/shader_source.h"
#include "engine/runtime/effect.h"
#include "engine/runtime/frame.h"
#include "engine/runtime/report.h"

namespace viscera {

/// Whether passes that have a compute shader use it. Contexts below OpenGL 4.3 never do and draw the same
/// picture.
enum class ComputeUse {
    automatic,  ///< on hardware; software renderers gain nothing from it
    on,
    off,
};

/// When the uncovered part of an opaque picture gets its clear value (Port::behind_depth). The picture is the
/// same.
enum class BackgroundFill {
    automatic,  ///< after drawing on hardware, where clears cost as much as drawing; before it elsewhere
    before,
    after,
};

struct RendererOptions {
    LogCallback log;
    /// Where shaders come from; empty: those embedded in the binary.
    ShaderReader shaders;
    /// GPU timer queries around each pass. Never on software renderers.
    bool timers = true;
    /// Ask for glGetError after each pass and throw what it says, and where a program is used without a value
    /// for each of its uniforms. KHR_debug messages go to the log in any case.
    bool check_errors = true;
    /// Called around each pass that draws, its clears included: for measuring.
    PassObserver observer;
    ComputeUse compute = ComputeUse::automatic;
    BackgroundFill background = BackgroundFill::automatic;
    /// Told of long work (reading volumes, summarising them) on the rendering thread, from within render();
    /// must not call the renderer. When it returns false, render() throws Error(usage) "cancelled", nothing
    /// is half-loaded, and the next render() begins that work anew.
    ProgressCallback progress{};
    /// Where what is long in the making is kept for the next process (io::DiskCache); empty: nowhere.
    std::filesystem::path cache_folder{};
};

/// One target of a frame, read back.
struct CapturedTarget {
    std::string name;
    Image image;
};

/// The dumped targets of one frame, all together, in the order of the dump list.
struct CapturedFrame {
    FrameReport report;
    std::vector<CapturedTarget> targets;
};

/// Called on the rendering thread, from render(), poll_captures() or finish_captures(), some frames after the
/// one captured.
using CaptureSink = std::function<void(CapturedFrame&&)>;

/// A copy of a target, as of a frame that may lie a little back.
struct WatchedTarget {
    std::string target;
    Image image;
    std::uint64_t frame = 0;  ///< Frame::index of the latest frame that it is right for
    double time_s = 0.0;      ///< and its time
    /// Frames rendered since: 0 once the last frame has arrived or when it changed nothing, mostly 1 while it
    /// changes, more when the GPU is behind.
    std::uint64_t frames_behind = 0;
    /// Changes whenever the image does, and is never one that another copy has or had: of another target,
    /// scene or renderer.
    std::uint64_t version = 0;
};

/// How watched targets come back.
enum class WatchPath {
    automatic,  ///< deferred on software renderers, whose read-backs wait for the frame; else buffered
    buffered,   ///< into pixel buffers, right after the frame
    deferred,   ///< into a copy on the GPU first, and from there once it is done
};

/// Which targets are read back: the scene's outputs, every target that lives, or names.
struct DumpRequest {
    enum class Kind { none, outputs, all, names };
    Kind kind = Kind::none;
    std::vector<std::string> names;
};

/// Renders a scene in the context that is current. Every member must be called with that context current, and
/// so must the destructor; without any, what draws or reads throws Error(context). Throws Error; after a
/// throw the host's state is restored and the renderer stays usable.
class Renderer {
  public:
    /// Throws Error(context) when the context offers less than OpenGL 3.3 core.
    Renderer(ProcAddress proc, const Registry& registry, RendererOptions options = {});
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    /// Takes a scene; throws Error(scene) that lists every fault and then keeps the scene it had. Files that
    /// have been written since are read anew. `imported`: targets that the frames will bring as
    /// Frame::imported.
    void set_scene(Scene scene, std::span<const ImportedTarget> imported = {});
    [[nodiscard]] const Scene& scene() const;
    /// Changes one parameter of a pass: pointer relative to its parameters ("/cloud/radius_mm"). Throws
    /// Error(scene).
    void set_parameter(std::string_view pass, std::string_view pointer, const nlohmann::json& value);

    /// Frame `index` of a sequence: size and camera as the scene gives them (two eyes where it has `stereo`),
    /// time = index / frames_per_second.
    [[nodiscard]] Frame frame(std::uint64_t index) const;
    /// A single picture of the scene at a time [s].
    [[nodiscard]] Frame still(double time_s) const;
    /// Whether what a frame shows depends on the frames before it (energy, blood): a sequence then has to be
    /// rendered from its beginning.
    [[nodiscard]] bool keeps_state() const;
    /// Renders one frame, of one eye or of two. With two, what depends on the eye is drawn for each, and its
    /// targets are called `NAME.left` and `NAME.right`; all else is drawn once. The report is valid until the
    /// next call.
    const FrameReport& render(const Frame& frame);

    /// Targets kept to the end of each frame besides the scene's outputs, so that they can be presented and
    /// read.
    void keep(std::vector<std::string> targets);
    /// Keeps copies of targets of colour, for logic that asks what they hold. Each frame that changes one
    /// sends the part that changed on its way, and never waits for it. Frames fail with Error(usage) for a
    /// target of depth.
    void watch(std::vector<std::string> targets, WatchPath path = WatchPath::automatic);
    /// The latest copy that has arrived, without waiting; valid until the next call of any member. Null: not
    /// watched, or none has arrived yet, of this scene: set_scene forgets those of the one before, and so
    /// does set_parameter where ports change with the parameter. What a frame could not send because too much
    /// was on its way is sent now, so copies catch up without further frames, unless the target is an
    /// imported texture or was given away.
    [[nodiscard]] const WatchedTarget* watched(std::string_view target);
    /// For logic to which age matters more than speed: waits until there is a copy of each watched target
    /// and none lies more than this many frames back. Holds where it is called after each frame; of an
    /// imported texture, for 1 or more.
    void wait_for_watched(std::uint64_t most_frames_behind);
    /// Which targets the next frames read back, and who receives them.
    void set_dump(DumpRequest request, CaptureSink sink);
    /// Hands over captures that have arrived, without waiting.
    void poll_captures();
    /// Waits for all captures and hands them over.
    void finish_captures();
    /// Reads one target of the last frame, waiting for it. Throws Error(usage) for a name that the frame does
    /// not hold.
    [[nodiscard]] Image read(std::string_view target);

    /// What the last frame called a target or output of the scene: its own name, or `NAME.left` and
    /// `NAME.right` where each of two eyes has one.
    [[nodiscard]] std::vector<std::string> names_of(std::string_view name) const;
    /// OpenGL name of the texture that holds an output of the last frame; valid until the next render(). 0:
    /// it is empty.
    [[nodiscard]] unsigned texture(std::string_view output) const;
    /// Gives the texture of an output of the last frame to the caller, who then deletes it; the next frame
    /// draws into a new one. 0: the output is empty or an imported texture.
    [[nodiscard]] unsigned release_texture(std::string_view output);

    /// The plan of the last frame's size, which its quality may have made smaller than the frame.
    [[nodiscard]] const Plan& plan() const;
    /// Compiles every program again from a folder; programs that fail keep their last good form and are
    /// logged. Number of failures.
    int reload_shaders(const std::filesystem::path& glsl_folder);
    [[nodiscard]] Log& log();
    [[nodiscard]] const ContextInfo& context_info() const;
    /// Files read and objects made that are held at present.
    [[nodiscard]] std::size_t asset_count() const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace viscera

#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/log.h"

namespace viscera {

/// A function that finds OpenGL functions by name, as every windowing library has one.
using ProcAddress = void* (*)(const char* name);

enum class Backend { egl_device, egl_surfaceless, osmesa, glfw, current };

/// "egl-device", "egl-surfaceless", "osmesa", "glfw", "current"
[[nodiscard]] std::string_view to_string(Backend backend);
/// What --backend takes: the names above, and "egl" for device then surfaceless, "auto" for device,
/// surfaceless, osmesa. Throws Error(usage) for another word.
[[nodiscard]] std::vector<Backend> parse_backends(std::string_view word);

struct ContextOptions {
    std::optional<int>
        egl_device;      ///< index among the EGL devices; none: the first that works, hardware first
    bool debug = false;  ///< ask for a debug context (KHR_debug messages)
    bool require_hardware = false;  ///< refuse software renderers
    /// Newest version asked for; where the driver has none, 3.3. Some drivers give just what is asked for,
    /// and compute shaders come with 4.3.
    std::array<int, 2> version{4, 3};
    int width = 1280;  ///< window [pixels], glfw only
    int height = 720;
    bool visible = true;  ///< glfw only
    std::string title = "viscera";
};

/// What a context says of itself.
struct ContextInfo {
    Backend backend = Backend::current;
    std::string vendor;
    std::string renderer;
    std::string version;
    int major = 0;
    int minor = 0;
    bool software = false;  ///< llvmpipe, softpipe, swrast, or another rasteriser on the CPU
    std::optional<int> egl_device;
    std::string
        remark;  ///< what a user should know: why a machine with a GPU renders in software; mostly empty
};

/// An OpenGL 3.3+ core context, current on the thread that made it. Destroying it releases it first.
class Context {
  public:
    virtual ~Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    /// Makes it current on this thread, after releasing what another backend left current (EGL and OSMesa
    /// share a slot).
    virtual void make_current() = 0;
    virtual void release() = 0;
    [[nodiscard]] virtual ProcAddress proc_address() const = 0;
    [[nodiscard]] const ContextInfo& info() const { return info_; }

  protected:
    Context() = default;
    ContextInfo info_;
};

/// Why a backend could not be had.
struct Refusal {
    Backend backend = Backend::current;
    std::string why;
};

/// Makes and makes current a context of one kind. Throws Error(context) that says why not: library not found
/// (with the Debian package to install), no display, no device of that index, version below 3.3, software
/// where hardware is required. `current` wraps what the caller made current with EGL, GLX (through `proc`) or
/// another; it owns nothing.
[[nodiscard]] std::unique_ptr<Context> create_context(Backend backend, const ContextOptions& options = {});
[[nodiscard]] std::unique_ptr<Context> wrap_current_context(ProcAddress proc);

/// Tries each in order; `refusals` receives why each before the one chosen was refused. Throws Error(context)
/// that lists every refusal when none works.
[[nodiscard]] std::unique_ptr<Context> create_first_context(std::span<const Backend> backends,
                                                            const ContextOptions& options,
                                                            std::vector<Refusal>& refusals);

/// One line of `viscera backends`.
struct BackendReport {
    Backend backend = Backend::current;
    std::optional<ContextInfo> info;  ///< none when refused
    std::string
        why;  ///< refusal, or a remark ("software: NVIDIA device files present but no EGL vendor file")
};

/// Tries every backend and every EGL device, and destroys each again.
[[nodiscard]] std::vector<BackendReport> probe_backends();

}  // namespace viscera

#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "engine/context/context.h"
#include "engine/core/scene.h"
#include "engine/runtime/effect.h"
#include "engine/runtime/renderer.h"

namespace viscera::app {

/// Messages of the library on stderr; stdout is for results.
[[nodiscard]] LogCallback stderr_log(bool verbose = false);

/// All effects that the app knows.
[[nodiscard]] Registry make_registry();

/// The options of every command that needs OpenGL.
struct ContextArguments {
    std::string backend = "auto";
    std::optional<int> egl_device;
    bool require_hardware = false;

    void add_to(CLI::App& command);
    /// Opens the first that works, says on stderr which and why others were refused.
    [[nodiscard]] std::unique_ptr<Context> open(const ContextOptions& options = {}) const;
};

/// The option of every command that renders.
struct ComputeArgument {
    std::string text = "auto";

    void add_to(CLI::App& command);
    /// Throws Error(usage).
    [[nodiscard]] ComputeUse value() const;
};

/// The option of every command that renders on what a user has: where the next run finds what was long in the
/// making.
struct CacheArgument {
    std::string text;

    void add_to(CLI::App& command);
    /// Empty: no cache. By default $XDG_CACHE_HOME/viscera or ~/.cache/viscera.
    [[nodiscard]] std::filesystem::path folder() const;
};

/// Says which renderer was chosen: software must never pass for hardware.
void name_renderer(const ContextInfo& info, const LogCallback& log);

/// The options of every command that takes a scene.
struct SceneArguments {
    std::filesystem::path file;
    std::vector<std::string> overrides;
    std::string resolution;

    void add_to(CLI::App& command);
    [[nodiscard]] Scene load() const;
};

/// "WxH" as two positive numbers. Throws Error(usage).
[[nodiscard]] std::pair<int, int> parse_resolution(const std::string& text);

}  // namespace viscera::app

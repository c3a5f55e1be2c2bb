#include "samples/viscera/session.h"

#include <charconv>
#include <cstdlib>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "effects/register_all.h"
#include "engine/core/error.h"

namespace viscera::app {

LogCallback stderr_log(bool verbose) {
    auto logger =
        std::make_shared<spdlog::logger>("viscera", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    logger->set_pattern("%^%l%$: %v");
    logger->set_level(verbose ? spdlog::level::debug : spdlog::level::info);
    return [logger](LogLevel level, std::string_view message) {
        switch (level) {
            case LogLevel::debug:
                return logger->debug("{}", message);
            case LogLevel::info:
                return logger->info("{}", message);
            case LogLevel::warning:
                return logger->warn("{}", message);
            case LogLevel::error:
                return logger->error("{}", message);
        }
    };
}

Registry make_registry() {
    Registry registry;
    register_all(registry);
    return registry;
}

void ContextArguments::add_to(CLI::App& command) {
    command.add_option("--backend", backend,
                       "auto, egl, egl-device, egl-surfaceless, osmesa or glfw; auto tries EGL devices, EGL "
                       "surfaceless, OSMesa");
    command.add_option("--egl-device", egl_device,
                       "this one of the EGL devices that `viscera backends` lists, and no other");
    command.add_flag("--require-hardware", require_hardware, "refuse software renderers");
}

std::unique_ptr<Context> ContextArguments::open(const ContextOptions& wanted) const {
    ContextOptions options = wanted;
    options.egl_device = egl_device;
    options.require_hardware = require_hardware;
    std::vector<Refusal> refusals;
    // Who names a device wants that one: other ways would draw on another.
    const bool chosen = egl_device && (backend == "auto" || backend == "egl");
    std::unique_ptr<Context> context =
        create_first_context(parse_backends(chosen ? "egl-device" : backend), options, refusals);
    const LogCallback log = stderr_log();
    for (const Refusal& refusal : refusals) {
        log(LogLevel::info, std::string(to_string(refusal.backend)) + " refused: " + refusal.why);
    }
    name_renderer(context->info(), log);
    return context;
}

void ComputeArgument::add_to(CLI::App& command) {
    command.add_option("--compute", text,
                       "compute shaders in place of fragment shaders where there are both: auto (on hardware "
                       "with OpenGL 4.3), on or off");
}

ComputeUse ComputeArgument::value() const {
    if (text == "auto") {
        return ComputeUse::automatic;
    }
    if (text != "on" && text != "off") {
        throw Error(ErrorCode::usage, "--compute", "'" + text + "' is none of auto, on, off");
    }
    return text == "on" ? ComputeUse::on : ComputeUse::off;
}

void CacheArgument::add_to(CLI::App& command) {
    command.add_option("--cache", text,
                       "folder where what was long in the making is kept for the next run, or off; "
                       "$XDG_CACHE_HOME/viscera or ~/.cache/viscera by default");
}

std::filesystem::path CacheArgument::folder() const {
    if (text == "off") {
        return {};
    }
    if (!text.empty()) {
        return text;
    }
    // The specification of these folders says that a relative one is to be ignored.
    const auto absolute = [](const char* variable) {
        const char* value = std::getenv(variable);
        const std::filesystem::path path = value == nullptr ? "" : value;
        return path.is_absolute() ? path : std::filesystem::path();
    };
    if (const auto cache = absolute("XDG_CACHE_HOME"); !cache.empty()) {
        return cache / "viscera";
    }
    const auto home = absolute("HOME");
    return home.empty() ? home : home / ".cache" / "viscera";
}

void name_renderer(const ContextInfo& info, const LogCallback& log) {
    log(LogLevel::info, "renders with " + std::string(to_string(info.backend)) + ": " + info.renderer +
                            ", OpenGL " + info.version + (info.software ? " (software)" : ""));
}

void SceneArguments::add_to(CLI::App& command) {
    command.add_option("SCENE", file, "scene file")->required();
    command
        .add_option("--set", overrides,
                    "/json/pointer=value: changes the scene before it is read; may be given many times")
        ->take_all()
        ->allow_extra_args(false)
        ->default_str("");
    command.add_option("--resolution", resolution, "WxH in place of the scene's");
}

Scene SceneArguments::load() const {
    std::vector<SceneOverride> parsed;
    for (const std::string& text : overrides) {
        parsed.push_back(parse_override(text));
    }
    Scene scene = load_scene(file, parsed);
    if (!resolution.empty()) {
        std::tie(scene.width, scene.height) = parse_resolution(resolution);
    }
    return scene;
}

std::pair<int, int> parse_resolution(const std::string& text) {
    const std::size_t cross = text.find('x');
    int width = 0;
    int height = 0;
    const auto number = [](std::string_view part, int& value) {
        const auto [end, failure] = std::from_chars(part.data(), part.data() + part.size(), value);
        return failure == std::errc{} && end == part.data() + part.size() && value > 0;
    };
    if (cross == std::string::npos || !number(std::string_view(text).substr(0, cross), width) ||
        !number(std::string_view(text).substr(cross + 1), height)) {
        throw Error(ErrorCode::usage, "--resolution", "'" + text + "' is not WxH with two positive numbers");
    }
    return {width, height};
}

}  // namespace viscera::app

#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "engine/core/camera.h"
#include "engine/core/graph.h"
#include "engine/core/params_json.h"
#include "engine/core/timeline.h"

namespace viscera {

/// What a scene says of one target; what it leaves out, the effect that writes it decides.
struct SceneTarget {
    std::string name;
    std::optional<PixelFormat> format;
    std::optional<SizeRule> size;
    std::optional<std::array<float, 4>> clear;
};

/// One pass as written: its parameters are read by its effect later.
struct ScenePass {
    std::string name;
    std::string effect;
    bool enabled = true;
    nlohmann::json parameters = nlohmann::json::object();
    std::map<std::string, std::string>
        targets;          ///< port -> target, where it differs from the effect's default; empty: unbound
    std::string pointer;  ///< of this pass in the file: "/passes/0"
};

/// A scene file, read and checked but for what only effects know.
struct Scene {
    std::filesystem::path file;  ///< as given; relative asset paths stand against its folder
    std::string name;
    int width = 1024;     ///< [pixels]
    int height = 1024;    ///< [pixels]
    double time_s = 0.0;  ///< time of frame 0
    double frames_per_second = 30.0;
    CameraParams camera;
    std::vector<SceneTarget> targets;
    std::vector<ScenePass> passes;
    std::vector<TimelineTrack> timeline;  ///< host values for frames that bring none
    std::vector<std::string> outputs;
    std::string hash;  ///< 16 hex digits over the scene's canonical JSON after overrides
};

/// `/json/pointer=value`: value is JSON, or a bare word taken as a string. Throws Error(usage).
struct SceneOverride {
    std::string pointer;
    nlohmann::json value;
};
[[nodiscard]] SceneOverride parse_override(std::string_view text);

/// Reads a scene from JSON text. Every fault (syntax with line and column, unknown key with 'did you mean',
/// wrong type, out of range, duplicate pass name, bad `$ref`) is listed in one Error(scene) whose text names
/// file and JSON pointer.
/// `$ref: "#/shared/NAME"` inside parameters stands for that part of the scene's `shared` object; keys beside
/// it win. An override whose pointer's parent does not exist is an Error(scene).
[[nodiscard]] Scene parse_scene(std::string_view text, const std::filesystem::path& file,
                                std::span<const SceneOverride> overrides = {});

/// As parse_scene, from a file. Throws Error(file) when it cannot be read.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file,
                               std::span<const SceneOverride> overrides = {});

/// An effect as the schema needs it: its name, what it does, and its parameters.
struct EffectSchema {
    std::string name;
    std::string doc;
    VisitFunction visit;
};

/// JSON Schema of scene files, with each effect's parameters tied to its name.
[[nodiscard]] nlohmann::json scene_schema(std::span<const EffectSchema> effects);

}  // namespace viscera

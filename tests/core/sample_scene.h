#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "engine/core/scene.h"

namespace viscera {

inline constexpr const char* valid_scene = R"({
    "$schema": "../schema/scene.schema.json",
    "version": 1,
    "comment": "a note",
    "name": "two passes",
    "resolution": [640, 480],
    "time_s": 2.5,
    "frames_per_second": 15,
    "camera": {"kind": "orthographic", "eye_mm": [0, -100, 0], "comment": "front"},
    "shared": {
        "flow": {"rate": 4, "mesh": "../meshes/a.glb", "points": [1, 2]},
        "fast": {"$ref": "#/shared/flow", "rate": 9},
        "three": 3
    },
    "targets": {
        "comment": "only what differs",
        "contrast.main": {"format": "r16f", "scale": 0.5, "clear": [1]},
        "fixed": {"size": [32, 16]}
    },
    "passes": [
        {"name": "first", "effect": "test.flow", "parameters": {"$ref": "#/shared/flow"}},
        {"name": "second", "effect": "test.flow", "enabled": false, "comment": ["any", "thing"],
         "parameters": {"$ref": "#/shared/fast", "points": [{"$ref": "#/shared/three"}]},
         "targets": {"main": "fixed"}}
    ],
    "outputs": ["contrast.main", "fixed"]
})";

[[nodiscard]] inline Scene parse(const std::string& text, const std::vector<SceneOverride>& overrides = {}) {
    return parse_scene(text, "scenes/a.json", overrides);
}

/// What the error says; every fault of a scene comes as Error(scene).
[[nodiscard]] inline std::string error_of(const std::string& text,
                                          const std::vector<SceneOverride>& overrides = {}) {
    try {
        (void)parse(text, overrides);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::scene);
        EXPECT_EQ(error.where(), "scenes/a.json");
        return error.what();
    }
    return "no error";
}

/// The valid scene with the value at a pointer replaced (null: removed).
[[nodiscard]] inline std::string with(const std::string& pointer, const nlohmann::json& value) {
    nlohmann::json document = nlohmann::json::parse(valid_scene);
    document[nlohmann::json::json_pointer(pointer)] = value;
    return document.dump();
}

[[nodiscard]] inline std::string without(const std::string& pointer) {
    nlohmann::json document = nlohmann::json::parse(valid_scene);
    const nlohmann::json::json_pointer place(pointer);
    document[place.parent_pointer()].erase(place.back());
    return document.dump();
}

}  // namespace viscera

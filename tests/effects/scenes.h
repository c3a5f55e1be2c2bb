#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace viscera::test {

/// Scenes as JSON, small and quick to draw. Each returns what a test then changes.

/// A camera that sees the tube whole, turned so that nothing lies along an axis.
inline nlohmann::json tube_camera() {
    return {
        {"kind", "c_arm"},           {"source_axis_distance_mm", 750},   {"source_image_distance_mm", 1200},
        {"detector_height_mm", 130}, {"isocentre_mm", {1.3, 0.7, -8.1}}, {"primary_deg", 23},
        {"secondary_deg", -11}};
}

inline nlohmann::json coronary_camera() {
    return {{"kind", "c_arm"},
            {"source_axis_distance_mm", 750},
            {"source_image_distance_mm", 1200},
            {"detector_height_mm", 220},
            {"primary_deg", -30},
            {"secondary_deg", -20}};
}

inline nlohmann::json scene_of(const nlohmann::json& camera, nlohmann::json passes, nlohmann::json outputs,
                               int width = 128, int height = 128) {
    return {{"version", 1},
            {"resolution", {width, height}},
            {"camera", camera},
            {"passes", std::move(passes)},
            {"targets", nlohmann::json::object()},
            {"outputs", std::move(outputs)}};
}

/// The tube with its centreline: contrast takes about 0.4 s to run through it.
inline nlohmann::json tube_parameters() {
    return {{"vessel",
             {{"mesh", "../meshes/tube.glb"},
              {"centreline", "../vessels/tube.centreline.json"},
              {"injection_mm", {0, 0, -40}},
              {"flow", {{"injection_speed_mm_s", 150}}}}},
            {"bolus", {{"start_s", 0.2}, {"duration_s", 1.5}, {"rise_s", 0.3}, {"washout_s", 0.4}}},
            {"cloud", {{"radius_mm", 25}, {"brightness", 0.9}, {"threshold", 0.05}}}};
}

inline nlohmann::json pass(const std::string& name, const std::string& effect,
                           nlohmann::json parameters = nlohmann::json::object(),
                           nlohmann::json targets = nlohmann::json::object()) {
    return {{"name", name},
            {"effect", effect},
            {"parameters", std::move(parameters)},
            {"targets", std::move(targets)}};
}

/// Gives targets full floats: two channels for the cloud, one for the rest.
inline void use_floats(nlohmann::json& scene, std::initializer_list<const char*> targets) {
    for (const std::string target : targets) {
        scene["targets"][target]["format"] = target == "contrast.cloud" ? "rg32f" : "r32f";
    }
}

}  // namespace viscera::test

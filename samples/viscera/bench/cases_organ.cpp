#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/scene_text.h"

namespace viscera::app {
namespace {

using nlohmann::json;

/// The organ with nothing but a colour map under one light.
json textured() {
    return {{"mesh", {{"file", "../meshes/organ.glb"}}},
            {"diffuse_map", "../images/organ_diffuse.png"},
            {"lights", {json::object()}}};
}

json with(json parameters, const std::string& key, json value) {
    parameters[key] = std::move(value);
    return parameters;
}

/// What tissue effects would bring, as pictures that are drawn once.
void fill(SceneText& scene, const std::string& target, const std::string& file, bool one_channel) {
    scene.pass("fill-" + target, "picture.image",
               {{"file", "../images/" + file}, {"fit", "stretch"}, {"monochrome", one_channel}},
               {{"image", target}});
    scene.target(target, one_channel ? "r16f" : "rgba16f", 0.5);
}

/// Depth of field on a picture that is drawn once a frame.
void measure_lens(Lab& lab, SceneText scene, const std::string& picture, ComputeUse compute,
                  const std::string& name) {
    scene.pass("depth_of_field", "organ.depth_of_field", json::object(),
               {{"colour", picture}, {"picture", "bench.final"}});
    scene.target("bench.final", "rgba16f");
    scene.pass("copy", "bench.copy1", nullptr, {{"a", picture}, {"out", "bench.copy"}});
    scene.target("bench.copy", "rgba16f");
    scene.output("bench.final").output("bench.copy");
    Stage stage(lab, scene.json(), {.compute = compute});
    stage.run();
    lab.add({.group = "organ",
             .name = name,
             .samples = stage.pass("depth_of_field"),
             .ceiling = "copy",
             .base = stage.pass("copy")});
}

}  // namespace

void run_organ(Lab& lab) {
    json frame = lab.empty_scene();
    frame["shared"] = json::object();
    // Turned a little each frame, so that nothing is cached; the organ fills most of the picture.
    frame["camera"] = {{"kind", "perspective"}, {"eye_mm", {10, -35, -190}}, {"target_mm", {-5, 10, 0}},
                       {"up", {0, -1, 0}},      {"vertical_fov_deg", 55},    {"near_mm", 5},
                       {"far_mm", 600},         {"orbit_deg_per_s", 4}};
    SceneText scene(frame);
    fill(scene, "bench.energy", "organ_normal.png", true);
    fill(scene, "bench.blood", "organ_diffuse.png", false);
    fill(scene, "bench.blood_normal", "organ_normal.png", false);

    json many = json::array();
    for (int i = 0; i < 8; ++i) {
        many.push_back({{"position", {i - 4, 3, 0}}, {"colour", {0.2, 0.2, 0.2}}, {"falloff_mm", 400}});
    }
    json spots = json::array();
    for (int i = 0; i < 64; ++i) {
        spots.push_back({{"centre", {-60 + i, -30, i % 8}}, {"radius", 5}});
    }
    const json relief = {{"map", "../images/organ_normal.png"}};
    const json focus = json::object();
    struct Feature {
        const char* name;
        json parameters;
        json targets;
        const char* effect = "organ.surface";
    };
    const json blood = {{"blood_colour", "bench.blood"}};
    json everything = with(textured(), "normal_map", relief);
    everything["focus"] = focus;
    everything["cut"] = {{"map", "../images/organ_cut.png"}};
    everything["hint"] = {{"map", "../images/organ_hint.png"}, {"period_s", 0}};
    everything["hematoma"] = {{"spots", spots}};
    everything["lights"] = many;
    const json all_targets = {
        {"blood_colour", "bench.blood"}, {"blood_normal", "bench.blood_normal"}, {"energy", "bench.energy"}};
    json speck = textured();
    speck["mesh"]["placement"] = {{"scale", {1e-3, 1e-3, 1e-3}}};
    const std::vector<Feature> features{
        {"one colour on the same mesh", textured(), json::object(), "bench.organ_ceiling"},
        {"textured", textured(), json::object()},
        {"relief", with(textured(), "normal_map", relief), json::object()},
        {"energy", textured(), {{"energy", "bench.energy"}}},
        {"blood", textured(), blood},
        {"blood with its normal",
         textured(),
         {{"blood_colour", "bench.blood"}, {"blood_normal", "bench.blood_normal"}}},
        {"cuts", with(textured(), "cut", {{"map", "../images/organ_cut.png"}}), json::object()},
        {"hint", with(textured(), "hint", {{"map", "../images/organ_hint.png"}, {"period_s", 0}}),
         json::object()},
        {"64 bruises", with(textured(), "hematoma", {{"spots", spots}}), json::object()},
        {"8 lights", with(textured(), "lights", many), json::object()},
        {"focus", with(textured(), "focus", focus), json::object()},
        {"membrane, sorted", with(textured(), "blending", "blended"), json::object()},
        {"everything", everything, all_targets},
        {"clear of the depth", speck, json::object(), "bench.organ_ceiling"}};
    for (std::size_t i = 0; i < features.size(); ++i) {
        json targets = features[i].targets;
        const std::string number = std::to_string(i);
        targets["colour"] = "bench.colour" + number;
        targets["depth"] = "bench.depth" + number;
        scene.pass("feature" + number, features[i].effect, features[i].parameters, targets);
        scene.output("bench.colour" + number);
    }
    // Whoever is given the depth of the clear next has hardly anything to clear.
    scene.pass("fill", "bench.organ_ceiling", textured(),
               {{"colour", "bench.fill"}, {"depth", "bench.fill_depth"}});
    scene.output("bench.fill");
    Stage stage(lab, scene.json());
    stage.run();
    const Samples& base = stage.pass("feature0");
    for (std::size_t i = 0; i < features.size(); ++i) {
        Row row{
            .group = "organ", .name = features[i].name, .samples = stage.pass("feature" + std::to_string(i))};
        if (i > 0) {
            row.ceiling = features[0].name;
            row.base = base;
        }
        lab.add(std::move(row));
    }

    SceneText lens(frame);
    const std::string picture = "bench.colour";
    lens.pass("organ", "organ.surface", with(with(textured(), "normal_map", relief), "focus", focus),
              {{"colour", picture}});
    measure_lens(lab, lens, picture, ComputeUse::off, "depth of field, 48 taps, fragment shader");
    if (lab.by_compute()) {
        measure_lens(lab, lens, picture, ComputeUse::on, "depth of field, 48 taps, compute shader");
    }
}

}  // namespace viscera::app

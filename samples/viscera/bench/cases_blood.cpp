#include <algorithm>
#include <optional>

#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/scene_text.h"

namespace viscera::app {
namespace {

constexpr double step_goal = 4.0;
constexpr double steps_per_s = 120.0;
// Looks and plans come every few steps: what a step takes is a mean over as many.
constexpr int steps_of_cycle = 8;
// Of the laparoscopy, from each time that is looked at: the hook neither comes nor goes meanwhile.
constexpr int most_cycles_at_work = 6;

/// The copy that steps are held against.
void end_scene(SceneText& scene) {
    scene.target("picture", "rgba32f")
        .target("copy", "rgba32f")
        .pass("source", "bench.source", {{"amount", 1.0}}, {{"out", "picture"}})
        .pass("copy", "bench.copy1", nullptr, {{"a", "picture"}, {"out", "copy"}});
    // All that blood reads is an output: what is not may lose its texture to another pass, and is made again.
    for (const char* name : {"tissue.blood_height", "tissue.blood_color", "tissue.blood_normal", "copy",
                             "tissue.gravity", "tissue.flow_right", "tissue.flow_top", "tissue.position",
                             "tissue.normal", "tissue.metric", "tissue.seam"}) {
        scene.output(name);
    }
}

/// Blood on a tube that fills the texture, one step of the simulation per frame, beside a plain copy of a
/// picture of the film's size.
nlohmann::json blood_scene(Lab& lab, const nlohmann::json& wounds, nlohmann::json liquid, bool film,
                           bool energy) {
    liquid["steps_per_s"] = steps_per_s;
    const int size = lab.options().width;
    const nlohmann::json mesh{{"file", "../meshes/tube.glb"}};
    SceneText scene(lab.empty_scene());
    if (film) {
        scene.target("tissue.blood_spill", "r32f")
            .pass("spill", "bench.source", {{"amount", 0.3}}, {{"out", "tissue.blood_spill"}});
    }
    scene.pass("bake", "tissue.bake", {{"mesh", mesh}, {"size", size}})
        .pass("gravity", "tissue.gravity", {{"size", size}});
    if (energy) {
        // A hook that moves beside the wound.
        scene
            .pass("energy", "tissue.coagulate",
                  {{"mesh", mesh},
                   {"size", size},
                   {"contacts",
                    {{{"from_mm", {0.0, -3.0, -35.0}},
                      {"to_mm", {0.0, -3.0, 265.0}},
                      {"end_s", 60.0},
                      {"power", 0.5},
                      {"sigma_mm", 1.0}}}}},
                  {{"energy", "tissue.energy"}, {"last", "tissue.energy"}})
            .output("tissue.energy");
    }
    scene.pass("blood", "tissue.blood",
               {{"mesh", mesh},
                {"size", size},
                {"state", "bench" + liquid.dump() + std::to_string(wounds.size()) + (film ? "film" : "") +
                              (energy ? "energy" : "")},
                {"liquid", liquid},
                {"wounds", wounds}});
    end_scene(scene);
    return scene.json();
}

nlohmann::json wounds_along(int count, double rate_mm3_s) {
    nlohmann::json wounds = nlohmann::json::array();
    for (int i = 0; i < count; ++i) {
        const double z = -30.0 + 60.0 * (i + 0.5) / count;
        wounds.push_back({{"position_mm", {0.0, -20.0, z}}, {"rate_mm3_s", rate_mm3_s}});
    }
    return wounds;
}

// About 100,000 drops that live at once. They leave no trail, run down the tube's side slowly, and are so
// small that even where some end none drowns in what they become.
constexpr int many_drops = 103000;
constexpr double many_drop_mm3 = 2e-5;
constexpr double many_until_s = 2.9;

nlohmann::json many_drops_scene(Lab& lab) {
    constexpr int wounds = 64;
    nlohmann::json places = nlohmann::json::array();
    for (int i = 0; i < wounds; ++i) {
        places.push_back({{"position_mm", {14.1, -14.1, -30.0 + 60.0 * (i + 0.5) / wounds}},
                          {"rate_mm3_s", many_drop_mm3 * many_drops / (many_until_s * wounds)},
                          {"stop_s", many_until_s}});
    }
    SceneText scene(blood_scene(lab, places,
                                {{"max_drops", 106496},
                                 {"viscosity_mpa_s", 1.0},
                                 {"drop_mm3", many_drop_mm3},
                                 {"trail_mm", 0.0},
                                 {"drop_life_s", 600.0}},
                                false, false));
    const nlohmann::json& passes = scene.json().at("passes");
    const auto blood =
        std::ranges::find(passes, "blood", [](const nlohmann::json& p) { return p.at("name"); });
    const nlohmann::json state = blood->at("parameters").at("state");
    return scene.pass("account", "tissue.blood_account", {{"state", state}})
        .output("tissue.blood_account")
        .json();
}

/// How many live at the end, all as large as they came.
std::optional<double> living_drops(Stage& stage, const nlohmann::json& scene) {
    if (std::ranges::find(scene.at("outputs"), "tissue.blood_account") == scene.at("outputs").end()) {
        return std::nullopt;
    }
    const Image account = stage.read("tissue.blood_account");
    double volume = 0.0;
    for (int i = 0; i < account.width * account.height; ++i) {
        volume += static_cast<double>(account.at(i % account.width, i / account.width, 2));
    }
    return volume / many_drop_mm3;
}

/// What is bled and coagulated in assets/scenes/laparoscopy.json, without what shows it, beside the same
/// copy.
nlohmann::json laparoscopy(const Lab& lab) {
    const nlohmann::json whole = lab.scene("laparoscopy.json");
    nlohmann::json emptied = whole;
    emptied["shared"]["tissue_size"] = lab.options().width;
    emptied["passes"] = emptied["outputs"] = nlohmann::json::array();
    SceneText scene(std::move(emptied));
    for (const nlohmann::json& pass : whole.at("passes")) {
        const auto name = pass.at("name").get<std::string>();
        if (name == "bake" || name == "relief" || name == "gravity" || name == "coagulate" ||
            name == "blood") {
            scene.add(pass);
        }
    }
    end_scene(scene);
    return scene.output("tissue.energy").output("tissue.relief").json();
}

}  // namespace

void run_blood(Lab& lab) {
    const int size = lab.options().width;
    const std::string at = " at " + std::to_string(size) + "^2";
    const auto measure = [&](const std::string& name, const nlohmann::json& scene, double time_s,
                             int most_cycles, int steps_per_frame) {
        const int frames_of_cycle = steps_of_cycle / steps_per_frame;
        const int cycles = std::clamp(lab.options().repeats / frames_of_cycle, 1, most_cycles);
        Stage stage(lab, scene,
                    {.time_s = 0.0,
                     .step_s = steps_per_frame / steps_per_s,
                     .repeats = cycles * frames_of_cycle,
                     .warm = static_cast<int>(time_s * steps_per_s) / steps_per_frame});
        stage.run();
        Samples both = stage.pass("blood");
        for (const char* energy : {"energy", "coagulate"}) {
            const Samples more = stage.pass_or_none(energy);
            both = more.empty() ? both : both + more;
        }
        const auto frames = static_cast<std::size_t>(frames_of_cycle);
        const bool each_seen = steps_per_frame == 1;
        lab.add({.group = "blood",
                 .name = name + (each_seen ? ", each step drawn" : "") + at,
                 .samples = means(both, frames, steps_of_cycle),
                 .value = living_drops(stage, scene),
                 .unit = "drops live",
                 .ceiling = "copy of one rgba32f picture of that size",
                 .base = means(stage.pass("copy"), frames, frames_of_cycle),
                 .goal = each_seen ? std::nullopt : std::optional(step_goal)});
    };
    constexpr int any = 1000;
    // In a window two steps and one picture make a frame of 1/60 s; the scene itself has 20 frames a second.
    for (const int steps_per_frame : {2, 1}) {
        for (const double time_s : {2.0, 4.0, 6.0, 8.0}) {
            measure("laparoscopy.json at " + std::to_string(static_cast<int>(time_s)) + " s",
                    laparoscopy(lab), time_s, most_cycles_at_work, steps_per_frame);
        }
        const auto on_tube = [&](const std::string& name, const nlohmann::json& wounds, double time_s,
                                 bool film, bool energy) {
            measure(name, blood_scene(lab, wounds, {{"max_drops", 16384}}, film, energy), time_s, any,
                    steps_per_frame);
        };
        on_tube("1 wound after 0.5 s", wounds_along(1, 30.0), 0.5, false, false);
        on_tube("the same and 1 contact of energy", wounds_along(1, 30.0), 0.5, false, true);
        on_tube("4 wounds after 1 s", wounds_along(4, 30.0), 1.0, false, false);
        on_tube("4 wounds and 1 contact of energy", wounds_along(4, 30.0), 1.0, false, true);
        on_tube("film on all of the surface", nlohmann::json::array(), 0.1, true, false);
    }
    if (lab.hardware()) {
        measure("100000 drops", many_drops_scene(lab), 3.0, any, 2);
    }
}

}  // namespace viscera::app

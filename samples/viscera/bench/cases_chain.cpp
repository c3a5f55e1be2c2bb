#include <cmath>

#include "engine/gl/timer.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/scene_text.h"

namespace viscera::app {
namespace {

// In the default scene: injection, both kinds of smoke and the blush at once, so that nothing is idle.
constexpr double busy_s = 1.5;

nlohmann::json in_float(nlohmann::json scene) {
    const std::map<std::string, std::string> formats{{"background", "r32f"},
                                                     {"contrast.main", "r32f"},
                                                     {"contrast.cloud", "rg32f"},
                                                     {"contrast.distance", "r32f"},
                                                     {"contrast.summary", "r32f"},
                                                     {"contrast.reflux", "r32f"},
                                                     {"contrast.extravasate", "r32f"},
                                                     {"contrast.delayed", "r32f"},
                                                     {"contrast.blush", "r32f"},
                                                     {"contrast.capillary", "r32f"},
                                                     {"final", "r32f"}};
    for (nlohmann::json& pass : scene["passes"]) {
        if (pass["name"] == "background") {
            pass["parameters"]["monochrome"] = true;
        }
    }
    for (const auto& [target, format] : formats) {
        scene["targets"][target]["format"] = format;
    }
    return scene;
}

bool drew(PassStatus status) {
    return status == PassStatus::run || status == PassStatus::reduced;
}

/// The emitter of the reflux at another size.
nlohmann::json reflux_of_size(const Lab& lab, double size) {
    nlohmann::json scene = lab.default_scene();
    for (nlohmann::json& pass : scene["passes"]) {
        if (pass["name"] == "reflux") {
            pass["parameters"]["emitters"][0]["size"] = size;
        }
    }
    scene["outputs"] = {"contrast.reflux"};
    return scene;
}

}  // namespace

void run_chain(Lab& lab) {
    Stage by_pass(lab, lab.default_scene(), {.time_s = busy_s});
    by_pass.run();
    Samples sum;
    for (const PassReport& pass : by_pass.report().passes) {
        if (!drew(pass.status)) {
            continue;
        }
        const Samples& samples = by_pass.pass(pass.name);
        lab.add({.group = "chain", .name = pass.name, .samples = samples});
        sum = sum.empty() ? samples : sum + samples;
    }
    lab.add({.group = "chain", .name = "sum of the passes", .samples = sum});
    Stage whole(lab, lab.default_scene(), {.by_pass = false, .time_s = busy_s});
    whole.run();
    lab.add({.group = "chain", .name = "frame", .samples = whole.whole()});
}

void run_cached(Lab& lab) {
    Stage moving(lab, lab.default_scene(), {.by_pass = false, .time_s = busy_s});
    Stage still(lab, lab.default_scene(), {.by_pass = false, .time_s = busy_s, .step_s = 0.0});
    moving.run();
    still.run();
    lab.add({.group = "cached", .name = "full frame", .samples = moving.whole()});
    lab.add({.group = "cached",
             .name = "cached frame",
             .samples = still.whole(),
             .error = largest_difference(still.shot("final", busy_s), moving.shot("final", busy_s)),
             .error_of = "full frame",
             .ceiling = "full frame",
             .base = moving.whole(),
             .goal = 0.05});
}

void run_region(Lab& lab) {
    Samples first;
    for (const double height : {110.0, 220.0, 440.0, 880.0}) {
        nlohmann::json scene = lab.empty_scene();
        scene["camera"]["detector_height_mm"] = height;
        Stage stage(lab, SceneText(scene)
                             .pass("vessels", "contrast.geometry", coronary())
                             .output("contrast.main")
                             .output("contrast.cloud")
                             .output("contrast.distance")
                             .json());
        stage.run();
        const Samples& samples = stage.pass("vessels");
        first = first.empty() ? samples : first;
        lab.add({.group = "region",
                 .name = "detector of " + std::to_string(static_cast<int>(height)) + " mm",
                 .samples = samples,
                 .ceiling = "detector of 110 mm",
                 .base = first});
    }
}

void run_sprites(Lab& lab) {
    struct Point {
        double area = 0.0;
        double time_ms = 0.0;
    };
    std::vector<Point> points;
    for (const double size : {0.2, 0.4, 0.8, 1.6, 2.4}) {
        Stage stage(lab, reflux_of_size(lab, size), {.time_s = busy_s});
        stage.run();
        const Image image = stage.read("contrast.reflux");
        double lit = 0.0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                lit += image.at(x, y, 0) > 0.0F ? 1.0 : 0.0;
            }
        }
        const Samples& samples = stage.pass("reflux");
        const double time = lab.hardware() ? times(samples).median : works(samples).median;
        points.push_back({lit, time});
        char size_text[16];
        std::snprintf(size_text, sizeof size_text, "size %.1f", size);
        lab.add(
            {.group = "sprites", .name = size_text, .samples = samples, .value = lit, .unit = "lit pixels"});
    }
    // Least squares: time = intercept + slope * area.
    double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (const Point& p : points) {
        n += 1.0;
        sx += p.area;
        sy += p.time_ms;
        sxx += p.area * p.area;
        sxy += p.area * p.time_ms;
    }
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    lab.add({.group = "sprites", .name = "slope", .value = 1e6 * slope, .unit = "ns/pixel"});
    lab.add({.group = "sprites", .name = "intercept", .value = (sy - slope * sx) / n, .unit = "ms"});
}

void run_cpu(Lab& lab) {
    Stage stage(lab, lab.default_scene(), {.calling_thread = true, .time_s = busy_s});
    stage.run();
    for (const PassReport& pass : stage.report().passes) {
        if (drew(pass.status)) {
            lab.add({.group = "cpu", .name = pass.name, .samples = stage.pass(pass.name)});
        }
    }
    lab.add({.group = "cpu", .name = "render()", .samples = stage.whole()});
    Stage restoring(lab, lab.default_scene(),
                    {.calling_thread = true, .time_s = busy_s, .host_state = HostStatePolicy::restore});
    restoring.run();
    lab.add({.group = "cpu",
             .name = "render(), host state restored",
             .samples = restoring.whole(),
             .ceiling = "render()",
             .base = stage.whole()});
    Stage still(lab, lab.default_scene(), {.calling_thread = true, .time_s = busy_s, .step_s = 0.0});
    still.run();
    lab.add({.group = "cpu",
             .name = "render(), cached",
             .samples = still.whole(),
             .ceiling = "render()",
             .base = stage.whole()});
}

void run_precision(Lab& lab) {
    Stage halves(lab, lab.default_scene(), {.by_pass = false, .time_s = busy_s});
    Stage floats(lab, in_float(lab.default_scene()), {.by_pass = false, .time_s = busy_s});
    halves.run();
    floats.run();
    lab.add({.group = "precision", .name = "float targets", .samples = floats.whole()});
    lab.add({.group = "precision",
             .name = "half targets",
             .samples = halves.whole(),
             .error = largest_difference(halves.shot("final", busy_s), floats.shot("final", busy_s)),
             .error_of = "the same chain in float targets",
             .ceiling = "float targets",
             .base = floats.whole()});
}

void run_resolution(Lab& lab) {
    constexpr std::array<std::pair<int, int>, 5> sizes{
        {{256, 256}, {512, 512}, {1024, 1024}, {1920, 1080}, {2048, 2048}}};
    for (const auto& [width, height] : sizes) {
        nlohmann::json scene = lab.default_scene();
        scene["resolution"] = {width, height};
        Stage stage(lab, scene, {.by_pass = false, .time_s = busy_s});
        stage.run();
        lab.add({.group = "resolution",
                 .name = std::to_string(width) + "x" + std::to_string(height),
                 .samples = stage.whole(),
                 .value = 1e6 * times(stage.whole()).median / (static_cast<double>(width) * height),
                 .unit = "ns/pixel"});
    }
}

}  // namespace viscera::app

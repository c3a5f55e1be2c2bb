#include <algorithm>
#include <cmath>

#include "engine/core/log.h"
#include "engine/io/mesh.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/scene_text.h"
#include "samples/viscera/bench/shader_pass.h"

namespace viscera::app {
namespace {

constexpr double injecting_s = 1.0;  // in the default scene: vessels half full, cloud at its densest

/// viscera's shaders with the opacity curve as the sum that defines it.
ShaderReader with_opacity_loop() {
    return [shaders = bench_shaders()](std::string_view name) {
        return shaders(name == "contrast/opacity.glsl" ? "bench/opacity_loop.glsl" : name);
    };
}

SceneText vessels_alone(const Lab& lab, const char* format) {
    SceneText scene(lab.empty_scene());
    scene.target("contrast.main", format).output("contrast.main");
    scene.pass("vessels", "contrast.main", coronary());
    return scene;
}

/// As many as the geometry pass draws, since it reads the mesh in the same way.
std::size_t vessel_vertices(const Lab& lab) {
    Log log(lab.options().log);
    return io::merge(io::load_meshes(lab.options().assets / "meshes" / "coronary.glb", {}, log))
        .positions.size();
}

}  // namespace

void run_geometry(Lab& lab) {
    SceneText scene(lab.empty_scene());
    scene.pass("fused", "contrast.geometry", coronary());
    scene.pass("main", "contrast.main", coronary(), {{"main", "alone.main"}});
    scene.pass("cloud", "contrast.cloud", coronary(), {{"cloud", "alone.cloud"}});
    scene.pass("distance", "contrast.distance", coronary(), {{"distance", "alone.distance"}});
    const std::array<std::string, 3> targets{"main", "cloud", "distance"};
    for (const std::string& name : targets) {
        scene.output("contrast." + name).output("alone." + name);
    }
    Stage stage(lab, scene.json(), {.time_s = injecting_s});
    stage.run();
    double error = 0.0;
    for (const std::string& name : targets) {
        error =
            std::max(error, largest_difference(stage.read("contrast." + name), stage.read("alone." + name)));
    }
    const Samples separate = stage.pass("main") + stage.pass("cloud") + stage.pass("distance");
    lab.add({.group = "geometry", .name = "three passes", .samples = separate});
    lab.add({.group = "geometry",
             .name = "one pass",
             .samples = stage.pass("fused"),
             .error = error,
             .error_of = "three passes",
             .ceiling = "three passes",
             .base = separate,
             .goal = 1.0});
}

void run_overlap(Lab& lab) {
    SceneText scene(lab.empty_scene());
    const std::array<std::string, 4> methods{"max", "depth", "painter", "thickness"};
    for (const std::string& method : methods) {
        scene.pass(method, "contrast.main", coronary({{"method", method}}), {{"main", method}});
        scene.output(method);
    }
    Stage stage(lab, scene.json(), {.time_s = injecting_s});
    stage.run();
    const Image first = stage.read(methods[0]);
    for (const std::string& method : methods) {
        lab.add({.group = "overlap",
                 .name = method,
                 .samples = stage.pass(method),
                 .error = method == "thickness"
                              ? std::nullopt
                              : std::optional(largest_difference(stage.read(method), first)),
                 .error_of = method == "thickness" ? "another picture: vessels add up" : "max",
                 .ceiling = "max",
                 .base = stage.pass(methods[0])});
    }
}

void run_opacity(Lab& lab) {
    SceneText curve(lab.empty_scene());
    curve.target("closed", "r32f").target("loop", "r32f").output("closed").output("loop");
    curve.pass("closed", "bench.opacity", {}, {{"out", "closed"}});
    curve.pass("loop", "bench.opacity_loop", {}, {{"out", "loop"}});
    Stage alone(lab, curve.json());
    alone.run();
    const auto error = [&](const char* target) {
        const Image image = alone.read(target);
        double largest = 0.0;
        for (int x = 0; x < image.width; ++x) {
            const double a = (x + 0.5) / image.width;
            double sum = 0.0;
            for (int i = 0; i < 25; ++i) {
                const double start = i / 25.0;
                sum += std::clamp(2.0 * (a - start) / (1.0 - start), 0.0, 1.0);
            }
            largest =
                std::max(largest, std::abs(static_cast<double>(image.at(x, 0, 0)) - std::min(1.0, sum)));
        }
        return largest;
    };
    constexpr const char* definition = "25 terms in double precision";
    lab.add({.group = "opacity",
             .name = "25 terms, alone",
             .samples = alone.pass("loop"),
             .error = error("loop"),
             .error_of = definition});
    lab.add({.group = "opacity",
             .name = "closed form, alone",
             .samples = alone.pass("closed"),
             .error = error("closed"),
             .error_of = definition,
             .ceiling = "25 terms",
             .base = alone.pass("loop")});

    const nlohmann::json scene = vessels_alone(lab, "r32f").json();
    Stage loop(lab, scene, {.shaders = with_opacity_loop()});
    Stage closed(lab, scene);
    loop.run();
    closed.run();
    lab.add({.group = "opacity", .name = "25 terms, vessels", .samples = loop.pass("vessels")});
    lab.add({.group = "opacity",
             .name = "closed form, vessels",
             .samples = closed.pass("vessels"),
             .error = largest_difference(closed.shot("contrast.main", injecting_s),
                                         loop.shot("contrast.main", injecting_s)),
             .error_of = "25 terms in float",
             .ceiling = "25 terms",
             .base = loop.pass("vessels")});
}

void run_density(Lab& lab) {
    nlohmann::json uploaded = lab.empty_scene();
    uploaded["shared"]["coronary"]["vessel"]["density"] = "per_vertex";
    SceneText host_scene(uploaded);
    host_scene.pass("vessels", "contrast.main", coronary()).output("contrast.main");
    Stage host(lab, host_scene.json(), {.time_s = injecting_s});
    Stage host_thread(lab, host_scene.json(), {.calling_thread = true, .time_s = injecting_s});
    const nlohmann::json arrival_scene = vessels_alone(lab, "r16f").json();
    Stage arrival(lab, arrival_scene, {.time_s = injecting_s});
    Stage arrival_thread(lab, arrival_scene, {.calling_thread = true, .time_s = injecting_s});
    arrival.run();
    arrival_thread.run();

    const std::size_t vertices = vessel_vertices(lab);
    std::vector<float> densities(vertices);
    HostValues values;
    std::uint64_t frames = 0;
    const auto upload = [&](Frame& frame) {
        ++frames;
        for (std::size_t i = 0; i < densities.size(); ++i) {
            densities[i] = static_cast<float>((i + 37 * frames) % 1024) / 1024.0F;
        }
        values.set("DENSITY", densities);
        frame.values = &values;
    };
    host.run(upload);
    host_thread.run(upload);
    lab.add({.group = "density", .name = "arrival time", .samples = arrival.pass("vessels")});
    lab.add({.group = "density",
             .name = "uploaded each frame",
             .samples = host.pass("vessels"),
             .value = static_cast<double>(vertices),
             .unit = "vertices",
             .ceiling = "arrival time",
             .base = arrival.pass("vessels")});
    lab.add({.group = "density",
             .name = "uploaded each frame, calling thread",
             .samples = host_thread.pass("vessels"),
             .ceiling = "arrival time, calling thread",
             .base = arrival_thread.pass("vessels")});
}

}  // namespace viscera::app

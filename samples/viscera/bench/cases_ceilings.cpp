#include <chrono>

#include "engine/gl/pixel_transfer.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/scene_text.h"

namespace viscera::app {
namespace {

constexpr double rate_steps = 32.0;  // as glsl/bench/rate.frag

/// Amount per millisecond of the median, in units of 1e9 per second.
double giga_per_second(double amount, const Samples& samples) {
    return amount / (times(samples).median * 1e6);
}

void copies(Lab& lab) {
    SceneText scene(lab.empty_scene());
    for (const FormatInfo& format : all_formats()) {
        if (format.is_depth) {
            continue;
        }
        const std::string name(format.name);
        scene.target("in." + name, format.name).target("out." + name, format.name);
        scene.target("clear." + name, format.name);
        scene.pass("source." + name, "bench.source", {}, {{"out", "in." + name}});
        scene.pass("copy." + name, "bench.copy1", {}, {{"a", "in." + name}, {"out", "out." + name}});
        scene.pass("clear." + name, "bench.clear", {}, {{"out", "clear." + name}});
        scene.output("out." + name).output("clear." + name);
    }
    Stage stage(lab, scene.json());
    stage.run();
    const double pixels = static_cast<double>(lab.options().width) * lab.options().height;
    for (const FormatInfo& format : all_formats()) {
        if (format.is_depth) {
            continue;
        }
        const std::string name(format.name);
        const double bytes = pixels * static_cast<double>(bytes_per_pixel(format.format));
        const Samples& copy = stage.pass("copy." + name);
        lab.add({.group = "ceilings",
                 .name = "copy " + name,
                 .samples = copy,
                 .value = giga_per_second(2.0 * bytes, copy),
                 .unit = "GB/s"});
        const Samples& clear = stage.pass("clear." + name);
        lab.add({.group = "ceilings",
                 .name = "clear " + name,
                 .samples = clear,
                 .value = giga_per_second(bytes, clear),
                 .unit = "GB/s",
                 .ceiling = "copy " + name,
                 .base = copy});
    }
}

void rates(Lab& lab) {
    SceneText scene(lab.empty_scene());
    for (const std::string name : {"r16f", "rgba16f", "r32f"}) {
        scene.target("in." + name, name).target("nearest." + name, name).target("linear." + name, name);
        scene.pass("source." + name, "bench.source", {}, {{"out", "in." + name}});
        for (const std::string filter : {"nearest", "linear"}) {
            scene.pass(filter + "." + name, "bench." + filter, {},
                       {{"a", "in." + name}, {"out", filter + "." + name}});
            scene.output(filter + "." + name);
        }
    }
    scene.pass("exp", "bench.exp", {}, {{"out", "exp"}}).output("exp");
    Stage stage(lab, scene.json());
    stage.run();
    const double operations = rate_steps * lab.options().width * lab.options().height;
    const auto report = [&](const std::string& name, const char* unit) {
        const Samples& samples = stage.pass(name);
        lab.add({.group = "ceilings",
                 .name = name,
                 .samples = samples,
                 .value = giga_per_second(operations, samples),
                 .unit = unit});
    };
    for (const std::string format : {"r16f", "rgba16f", "r32f"}) {
        report("nearest." + format, "G fetches/s");
        report("linear." + format, "G fetches/s");
    }
    report("exp", "G/s");
}

void triangles(Lab& lab) {
    constexpr double count = 100000.0;
    SceneText scene(lab.empty_scene());
    scene.pass("vertices", "bench.vertices", {{"amount", count}}, {{"out", "vertices"}});
    scene.pass("triangles", "bench.triangles", {{"amount", count}}, {{"out", "triangles"}});
    scene.output("vertices").output("triangles");
    Stage stage(lab, scene.json());
    stage.run();
    const Samples& vertices = stage.pass("vertices");
    lab.add({.group = "ceilings",
             .name = "vertices",
             .samples = vertices,
             .value = 1e3 * giga_per_second(3.0 * count, vertices),
             .unit = "M vertices/s"});
    const Samples& drawn = stage.pass("triangles");
    lab.add({.group = "ceilings",
             .name = "triangles of half a pixel",
             .samples = drawn,
             .value = 1e3 * giga_per_second(count, drawn),
             .unit = "M triangles/s"});
}

double milliseconds_now() {
    using Milliseconds = std::chrono::duration<double, std::milli>;
    return Milliseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

void run_ceilings(Lab& lab) {
    copies(lab);
    rates(lab);
    triangles(lab);
}

void run_read_back(Lab& lab) {
    const double pixels = static_cast<double>(lab.options().width) * lab.options().height;
    for (const FormatInfo& format : all_formats()) {
        if (format.is_depth) {
            continue;
        }
        const gl::Texture texture = gl::Texture::make_2d(lab.gl(), lab.options().width, lab.options().height,
                                                         format.format, "read back");
        gl::ReadBack read_back(lab.gl());
        Samples waiting;
        Samples asking;
        Samples arriving;
        for (int i = -2; i < lab.options().repeats; ++i) {
            lab.gl().Finish();
            const double start = milliseconds_now();
            (void)gl::read_texture(lab.gl(), texture);
            const double read = milliseconds_now();
            read_back.start(texture, 0);
            const double asked = milliseconds_now();
            (void)read_back.wait();
            const double arrived = milliseconds_now();
            if (i >= 0) {  // the first ones make buffers
                waiting.push_back({read - start, 0.0});
                asking.push_back({asked - read, 0.0});
                arriving.push_back({arrived - read, 0.0});
            }
        }
        const double bytes = pixels * static_cast<double>(bytes_per_pixel(format.format));
        const std::string name(format.name);
        lab.add({.group = "readback",
                 .name = name + " waiting",
                 .samples = waiting,
                 .value = giga_per_second(bytes, waiting),
                 .unit = "GB/s"});
        lab.add({.group = "readback",
                 .name = name + " asking",
                 .samples = asking,
                 .ceiling = name + " waiting",
                 .base = waiting});
        lab.add({.group = "readback",
                 .name = name + " asking to arrival",
                 .samples = arriving,
                 .value = giga_per_second(bytes, arriving),
                 .unit = "GB/s",
                 .ceiling = name + " waiting",
                 .base = waiting});
    }
}

}  // namespace viscera::app

#include <cmath>
#include <fstream>

#include "engine/core/error.h"
#include "engine/core/image_compare.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/volume_scene.h"

// What spares rays where they are not looked for: mixed resolution, one frame for two eyes, foveation.

namespace viscera::app {
namespace {

using nlohmann::json;

/// `scale` of the lab's resolution; less on software renderers where it is 0.
json scene_file(const Lab& lab, std::string_view name, double scale = 0.0) {
    const std::filesystem::path file = lab.options().assets / "scenes" / (std::string(name) + ".json");
    std::ifstream stream(file);
    if (!stream) {
        throw Error(ErrorCode::file, file.string(), "cannot be opened; --assets names the folder");
    }
    json scene = json::parse(stream);
    scale = scale > 0.0 ? scale : lab.hardware() ? 1.0 : 0.5;
    scene["resolution"] = {std::lround(scale * lab.options().width),
                           std::lround(scale * lab.options().height)};
    return scene;
}

/// Moves the eyes by a billionth of a millimetre a frame, so that nothing is cached and nothing changes.
void nudge_both(Frame& frame) {
    const double step = 1e-9 * static_cast<double>(frame.index);
    for (View& eye : frame.eyes) {
        eye.view[3][0] += step;
    }
}

struct MixedKnob {
    std::string name;
    double scale;
    double tolerance;
};

}  // namespace

void run_mixed(Lab& lab) {
    const std::vector<MixedKnob> knobs{{"a quarter of the rays, tolerance 0.02", 0.5, 0.02},
                                       {"a quarter, 0.04", 0.5, 0.04},
                                       {"a quarter, 0.06", 0.5, 0.06},
                                       {"a quarter, all filled in but edges of the mesh", 0.5, 10.0},
                                       {"a ninth, 0.04", 1.0 / 3, 0.04},
                                       {"a sixteenth, 0.04", 0.25, 0.04}};
    json scene = scene_file(lab, "mixed", 1.0);
    const json mesh = scene["passes"][0];
    const json cast = scene["passes"][1];
    scene["passes"] = {mesh};
    scene["outputs"] = json::array();
    scene["targets"] = json::object();
    const auto add = [&](const std::string& name, const json& mixed, const json& targets) {
        json pass = cast;
        pass["name"] = name;
        pass["parameters"].erase("mixed");
        if (!mixed.is_null()) {
            pass["parameters"]["mixed"] = mixed;
        }
        pass["targets"] = targets;
        scene["passes"].push_back(pass);
    };
    add("full", nullptr, {{"colour", "full"}});
    scene["outputs"].push_back("full");
    for (std::size_t i = 0; i < knobs.size(); ++i) {
        const std::string coarse = "coarse." + std::to_string(i);
        add(coarse, {{"pass", "coarse"}}, {{"colour", coarse}});
        add(key(i), {{"pass", "fine"}, {"tolerance", knobs[i].tolerance}},
            {{"colour", key(i)}, {"coarse", coarse}});
        scene["targets"][coarse] = {{"scale", knobs[i].scale}};
        scene["outputs"].push_back(key(i));
    }
    Stage stage(lab, scene);
    stage.run(nudge_both);
    const Image full = stage.read("full");
    lab.add({.group = "mixed", .name = "every ray cast", .samples = stage.pass("full")});
    for (std::size_t i = 0; i < knobs.size(); ++i) {
        const CompareResult apart = compare(stage.read(key(i)), full, {});
        const Samples coarse = stage.pass("coarse." + std::to_string(i));
        lab.add({.group = "mixed",
                 .name = knobs[i].name,
                 .samples = coarse + stage.pass(key(i)),
                 .error = apart.max,
                 .rms = apart.rms,
                 .error_of = "every ray cast",
                 .value = apart.psnr_db,
                 .unit = "dB",
                 .ceiling = "every ray cast",
                 .base = stage.pass("full"),
                 .goal = 0.4});
        lab.add({.group = "mixed",
                 .name = "  of this the coarse pass",
                 .samples = coarse,
                 .ceiling = "every ray cast",
                 .base = stage.pass("full")});
    }
}

void run_eyes(Lab& lab) {
    for (const char* name : {"stereo", "angiography"}) {
        json scene = scene_file(lab, name);
        scene["camera"]["stereo"] = {{"interpupillary_mm", 63}};
        Stage two(lab, scene, {.by_pass = false});
        two.run(nudge_both);
        scene["camera"].erase("stereo");
        Stage one(lab, scene, {.by_pass = false});
        one.run(nudge_both);
        lab.add({.group = "eyes", .name = std::string(name) + ", one eye", .samples = one.whole()});
        lab.add({.group = "eyes",
                 .name = std::string(name) + ", two eyes in one frame",
                 .samples = two.whole(),
                 .ceiling = "two frames of one eye",
                 .base = one.whole() + one.whole()});
    }
}

void run_fovea(Lab& lab) {
    VolumeScene scene(lab, "head");
    scene.change({{"sampling", {{"step", 0.5}, {"tolerance", 0.0}}}});
    std::vector<Variant> variants{{"step 0.5 everywhere"}};
    for (const int factor : {2, 4, 8}) {
        json fovea{{"radius", 0.1}, {"outer_radius", 0.3}, {"step_factor", factor}};
        variants.push_back(
            {"up to " + std::to_string(factor) + " times as long", {{"sampling", {{"fovea", fovea}}}}});
    }
    variants.push_back({"step 2 everywhere", {{"sampling", {{"step", 2.0}}}}});
    Stage stage(lab, scene.json(variants, "rgba16f", lab.hardware() ? 1.0 : 0.5));
    stage.run(nudge);
    const Image fine = stage.read(key(0));
    for (std::size_t i = 0; i < variants.size(); ++i) {
        const CompareResult apart = compare(stage.read(key(i)), fine, {});
        lab.add({.group = "fovea",
                 .name = variants[i].name,
                 .samples = stage.pass(key(i)),
                 .error = apart.max,
                 .rms = apart.rms,
                 .error_of = variants[0].name,
                 .value = apart.psnr_db,
                 .unit = "dB",
                 .ceiling = i == 0 ? "" : variants[0].name,
                 .base = i == 0 ? Samples() : stage.pass(key(0))});
    }
}

}  // namespace viscera::app

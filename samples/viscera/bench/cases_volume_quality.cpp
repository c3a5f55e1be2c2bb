#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/volume_scene.h"

namespace viscera::app {
namespace {

using nlohmann::json;

struct Knob {
    std::string name;
    json changes;
};

json in_sampling(const char* key, const json& value) {
    return {{"sampling", {{key, value}}}};
}

json in_function(const char* key, const json& value) {
    return {{"transfer_function", {{key, value}}}};
}

/// Every knob on its own, from the defaults.
std::vector<Knob> knobs() {
    std::vector<Knob> all;
    all.push_back({"as by default", json::object()});
    all.push_back({"termination never", in_sampling("termination", 0.0)});
    all.push_back({"termination 1/64", in_sampling("termination", 1.0 / 64)});
    all.push_back({"termination 1/16", in_sampling("termination", 1.0 / 16)});
    all.push_back({"tolerance 0.02", in_sampling("tolerance", 0.02)});
    all.push_back({"tolerance 0.05", in_sampling("tolerance", 0.05)});
    all.push_back({"tolerance 0.1", in_sampling("tolerance", 0.1)});
    all.push_back({"tolerance 0.3", in_sampling("tolerance", 0.3)});
    all.push_back({"table of 256", in_function("entries", 256)});
    all.push_back({"table of 1024", in_function("entries", 1024)});
    all.push_back({"table of 16384", in_function("entries", 16384)});
    all.push_back(
        {"table of 256, interpolated", {{"transfer_function", {{"entries", 256}, {"interpolate", true}}}}});
    all.push_back({"table interpolated", in_function("interpolate", true)});
    all.push_back({"atlas", {{"volume", {{"storage", "atlas"}}}}});
    all.push_back({"linear_fp32", in_sampling("filter", "linear_fp32")});
    all.push_back({"jitter hash", in_sampling("jitter", "hash")});
    all.push_back({"jitter blue noise", in_sampling("jitter", "blue_noise")});
    all.push_back({"not skipped", in_sampling("skip", false)});
    return all;
}

}  // namespace

void run_quality(Lab& lab) {
    const double scale = lab.hardware() ? 1.0 : 0.5;
    constexpr double judged_scale = 0.25;
    VolumeScene scene(lab, "head");
    // The defaults, on the flat look: light and tolerance are the scene's.
    scene.change({{"shading", {{"enabled", false}}}, {"sampling", nullptr}});
    std::vector<Judged> judged;
    for (const Knob& knob : knobs()) {
        judged.push_back({{knob.name, knob.changes}, judged.empty() ? exact_composite() : json()});
    }
    const std::vector<PictureQuality> qualities = judge(lab, scene, judged, judged_scale);
    std::vector<Variant> variants;
    for (const Judged& one : judged) {
        variants.push_back(one.variant);
    }
    json drawn = scene.json(variants, "rgba16f", scale);
    // Limits drawn as faces are passes of their own.
    const std::string two_pass = "two.pass";
    json cast = drawn["passes"][0];
    cast["name"] = two_pass;
    cast["parameters"]["sampling"]["limits"] = "two_pass";
    cast["targets"] = {{"colour", two_pass}};
    for (const std::string side : {"entry", "exit"}) {
        json parameters{{"volume", cast["parameters"]["volume"]}};
        drawn["passes"].push_back({{"name", side}, {"effect", "volume." + side}, {"parameters", parameters}});
    }
    drawn["passes"].push_back(cast);
    drawn["outputs"].push_back(two_pass);
    drawn["targets"][two_pass] = {{"format", "rgba16f"}};
    Stage stage(lab, drawn);
    stage.run(nudge);
    const Samples& base = stage.pass(key(0));
    for (std::size_t i = 0; i < judged.size(); ++i) {
        const std::string& name = judged[i].variant.name;
        lab.add({.group = "quality",
                 .name = name,
                 .samples = stage.pass(key(i)),
                 .error = qualities[i].difference.max,
                 .rms = qualities[i].difference.rms,
                 .error_of = std::string(exact_name),
                 .value = qualities[i].samples_per_pixel,
                 .unit = "samples/pixel",
                 .ceiling = i == 0 ? "" : judged[0].variant.name,
                 .base = i == 0 ? Samples() : base});
    }
    const CompareResult same = compare(stage.read(two_pass), stage.read(key(0)), {});
    lab.add({.group = "quality",
             .name = "two_pass, its faces included",
             .samples = stage.pass("entry") + stage.pass("exit") + stage.pass(two_pass),
             .error = same.max,
             .rms = same.rms,
             .error_of = "analytic limits",
             .ceiling = judged[0].variant.name,
             .base = base});
}

}  // namespace viscera::app

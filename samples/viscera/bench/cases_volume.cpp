#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/volume_scene.h"

namespace viscera::app {
namespace {

using nlohmann::json;

// Parts of the picture in which exact pictures come within seconds on two cores.
constexpr double judged_scale = 0.25;

json sampling(const char* scheme, double step, bool skip) {
    return {{"scheme", scheme}, {"step", step},       {"skip", skip},         {"termination", 0.0},
            {"tolerance", 0.0}, {"filter", "linear"}, {"gradient", "central"}};
}

Row quality_row(std::string group, const Variant& variant, const PictureQuality& quality,
                const Samples& samples) {
    return {.group = std::move(group),
            .name = variant.name,
            .samples = samples,
            .error = quality.difference.max,
            .rms = quality.difference.rms,
            .error_of = std::string(exact_name),
            .value = quality.samples_per_pixel,
            .unit = "samples/pixel"};
}

/// Every ray function over the same rays and, but for surfaces and gradients, the same number of samples.
void against_ceiling(Lab& lab, ComputeUse compute, const std::string& group) {
    constexpr double step = 1.0;
    VolumeScene scene(lab, "head");
    scene.change({{"shading", {{"enabled", false}}}, {"sampling", sampling("midpoint", step, false)}});
    const json surfaces{{"function", "isosurface"},
                        {"isosurface", {{"values", {{{"value", 300}}}}}},
                        {"sampling", {{"skip", true}}}};
    const std::vector<Judged> judged{
        {{"composite", json::object()}, exact_composite()},
        {{"composite, two Gauss points a slab", {{"sampling", {{"scheme", "gauss"}}}}}, nullptr},
        {{"composite, shaded", {{"shading", {{"enabled", true}}}}}, exact_composite()},
        {{"composite, shaded, gradients kept",
          {{"shading", {{"enabled", true}}}, {"sampling", {{"gradient", "precomputed"}}}}},
         nullptr},
        {{"mip", {{"function", "mip"}}}, exact_cells()},
        {{"xray", {{"function", "xray"}, {"xray", {{"water_attenuation_per_mm", 0.012}}}}}, exact_cells()},
        {{"isosurface, skipping", surfaces}, exact_cells()}};
    const std::vector<PictureQuality> qualities = judge(lab, scene, judged, judged_scale);
    std::vector<Variant> variants{{"ceiling", json::object(), "bench.ray_ceiling"}};
    for (const Judged& one : judged) {
        variants.push_back(one.variant);
    }
    Stage stage(lab, scene.json(variants, "rgba16f"), {.compute = compute});
    stage.run(nudge);
    const Samples& ceiling = stage.pass(key(0));
    const double samples = qualities[0].samples_per_pixel * lab.options().width * lab.options().height;
    lab.add({.group = group,
             .name = "ceiling",
             .samples = ceiling,
             .value = samples / (1e6 * times(ceiling).median),
             .unit = "G trilinear samples/s"});
    const std::map<std::string, double> goals{{"composite", 1 / 0.60}, {"mip", 1 / 0.85}, {"xray", 1 / 0.85}};
    for (std::size_t i = 0; i < judged.size(); ++i) {
        const Variant& variant = judged[i].variant;
        Row row = quality_row(group, variant, qualities[i], stage.pass(key(i + 1)));
        row.ceiling = "ceiling";
        row.base = ceiling;
        if (const auto goal = goals.find(variant.name); goal != goals.end()) {
            row.goal = goal->second;
        }
        lab.add(std::move(row));
    }
}

/// Colours as they are against one of their channels.
void of_colours(Lab& lab) {
    VolumeScene scene(lab, "cryosections");
    // Less dense than to be looked at: what is opaque within a voxel only shows where the first sample lies.
    scene.change({{"shading", {{"enabled", false}}},
                  {"accumulate", {{"opacity", 40}}},
                  {"sampling", sampling("midpoint", 1.0, true)}});
    const json lit{{"shading", {{"enabled", true}}}};
    const std::vector<Judged> judged{
        {{"accumulate, one channel", {{"accumulate", {{"channels", json::array()}}}}}, exact_composite()},
        {{"accumulate, three channels", json::object()}, exact_composite()},
        {{"accumulate, three channels, shaded", lit}, exact_composite()}};
    const std::vector<PictureQuality> qualities = judge(lab, scene, judged, judged_scale);
    std::vector<Variant> variants;
    for (const Judged& one : judged) {
        variants.push_back(one.variant);
    }
    Stage stage(lab, scene.json(variants, "rgba16f"));
    stage.run(nudge);
    for (std::size_t i = 0; i < judged.size(); ++i) {
        lab.add(quality_row("volume, colours", judged[i].variant, qualities[i], stage.pass(key(i))));
    }
}

}  // namespace

void run_volume(Lab& lab) {
    against_ceiling(lab, ComputeUse::off, "volume, fragment shader");
    if (lab.by_compute()) {
        against_ceiling(lab, ComputeUse::on, "volume, compute shader");
    }
    of_colours(lab);
}

void run_steps(Lab& lab) {
    // On software renderers fine steps of all schemes would take minutes.
    const double scale = lab.hardware() ? 1.0 : 0.5;
    VolumeScene scene(lab, "head");
    scene.change({{"shading", {{"enabled", false}}}, {"sampling", sampling("midpoint", 1.0, true)}});
    std::vector<Judged> judged{{{"cell", {{"sampling", {{"scheme", "cell"}}}}}, exact_composite()}};
    for (const char* scheme : {"midpoint", "gauss", "preintegrated"}) {
        for (const char* step : {"4", "2", "1", "0.5", "0.25", "0.125"}) {
            judged.push_back({{std::string(scheme) + ", step " + step,
                               {{"sampling", {{"scheme", scheme}, {"step", std::stod(step)}}}}},
                              nullptr});
        }
    }
    const std::vector<PictureQuality> qualities = judge(lab, scene, judged, judged_scale);
    std::vector<Variant> variants;
    for (const Judged& one : judged) {
        variants.push_back(one.variant);
    }
    Stage stage(lab, scene.json(variants, "rgba16f", scale));
    stage.run(nudge);
    for (std::size_t i = 0; i < judged.size(); ++i) {
        lab.add(quality_row("steps", judged[i].variant, qualities[i], stage.pass(key(i))));
    }
}

}  // namespace viscera::app

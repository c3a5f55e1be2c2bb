#include <algorithm>
#include <cmath>

#include "effects/contrast/summarize_curve.h"
#include "effects/filter/gaussian_effect.h"
#include "samples/viscera/bench/cases.h"
#include "samples/viscera/bench/scene_text.h"

namespace viscera::app {
namespace {

constexpr const char* double_reference = "double precision of the inputs as stored";
constexpr double pass_goal = 1.2;
// References look at every so many pixels: enough to meet all phases of the inputs' waves.
constexpr int reference_step = 5;

/// Largest difference between a target and a function of the pixel.
template <class Reference>
double error_against(const Image& image, Reference&& reference) {
    double largest = 0.0;
    for (int y = 0; y < image.height; y += reference_step) {
        for (int x = 0; x < image.width; x += reference_step) {
            largest = std::max(largest, std::abs(static_cast<double>(image.at(x, y, 0)) - reference(x, y)));
        }
    }
    return largest;
}

SceneText& source(SceneText& scene, const std::string& name, const char* format, double amount,
                  double scale = 1.0) {
    return scene.target(name, format, scale)
        .pass("source." + name, "bench.source", {{"amount", amount}}, {{"out", name}});
}

struct Layer {
    const char* port;
    const char* target;
    double amount;
    double scale;
};
// In the order in which scenes add them; the capillary blush is kept at a quarter of the resolution.
constexpr std::array<Layer, 5> layers{{{"background", "background", 0.0, 1.0},
                                       {"summary", "summary", 1.0, 1.0},
                                       {"reflux", "reflux", 2.0, 1.0},
                                       {"extravasate", "extravasate", 3.0, 1.0},
                                       {"capillary", "capillary", 4.0, 0.25}}};
constexpr std::array<const char*, 5> copy_ports{"a", "b", "c", "d", "e"};

/// What a linear fetch of a smaller picture gives at a pixel of a larger one.
double magnified(const Image& image, double x, double y) {
    const double u = std::clamp(x, 0.5, image.width - 0.5) - 0.5;
    const double v = std::clamp(y, 0.5, image.height - 0.5) - 0.5;
    const int i = std::min(static_cast<int>(u), image.width - 2);
    const int j = std::min(static_cast<int>(v), image.height - 2);
    const auto at = [&](int dx, int dy) { return static_cast<double>(image.at(i + dx, j + dy, 0)); };
    return std::lerp(std::lerp(at(0, 0), at(1, 0), u - i), std::lerp(at(0, 1), at(1, 1), u - i), v - j);
}

double toned(bool thesis, double background, double ratio, double darkest) {
    if (thesis) {
        return ratio < 0.5 ? std::lerp(background, 0.1, 2.0 * ratio) : 0.15 * ratio;
    }
    return background * std::pow(darkest, ratio);
}

}  // namespace

void run_summarize(Lab& lab) {
    SceneText scene(lab.empty_scene());
    source(scene, "main", "r16f", 0.0);
    source(scene, "cloud", "rg16f", 1.0);
    scene.target("copy", "r16f");
    scene.pass("copy", "bench.copy2", {}, {{"a", "main"}, {"b", "cloud"}, {"out", "copy"}});
    scene.output("copy").output("main").output("cloud");
    const std::array<const char*, 3> transitions{"smooth", "thesis", "densest"};
    for (const char* transition : transitions) {
        scene.target(transition, "r16f");
        scene.pass(transition, "contrast.summarize", {{"transition", transition}},
                   {{"main", "main"}, {"cloud", "cloud"}, {"summary", transition}});
        scene.output(transition);
    }
    Stage stage(lab, scene.json());
    stage.run();
    const Image main = stage.read("main");
    const Image cloud = stage.read("cloud");
    for (std::size_t i = 0; i < transitions.size(); ++i) {
        const auto transition = static_cast<contrast::SummarizeTransition>(i);
        const double error = error_against(stage.read(transitions[i]), [&](int x, int y) {
            return contrast::summarize(main.at(x, y, 0), cloud.at(x, y, 0), cloud.at(x, y, 1), transition);
        });
        lab.add({.group = "summarize",
                 .name = transitions[i],
                 .samples = stage.pass(transitions[i]),
                 .error = error,
                 .error_of = double_reference,
                 .ceiling = "copy of the same 2 inputs",
                 .base = stage.pass("copy"),
                 .goal = pass_goal});
    }
}

void run_composite(Lab& lab) {
    constexpr double darkest = 0.12;
    SceneText scene(lab.empty_scene());
    for (const Layer& layer : layers) {
        source(scene, layer.target, "r16f", layer.amount, layer.scale).output(layer.target);
    }
    const auto name_of = [](std::size_t count, const char* tone) {
        return std::to_string(count) + (count == 1 ? " layer, " : " layers, ") + tone;
    };
    const std::array<const char*, 2> tones{"beer_lambert", "thesis"};
    for (std::size_t count = 1; count <= layers.size(); ++count) {
        nlohmann::json copied{{"out", "copy" + std::to_string(count)}};
        for (std::size_t i = 0; i < count; ++i) {
            copied[copy_ports[i]] = layers[i].target;
        }
        scene.target(copied["out"], "r16f");
        scene.pass(copied["out"].get<std::string>(), "bench.copy" + std::to_string(count), {}, copied);
        scene.output(copied["out"].get<std::string>());
        for (const char* tone : tones) {
            const std::string target = std::string(tone) + std::to_string(count);
            nlohmann::json bound{{"final", target}};
            for (std::size_t i = 0; i < layers.size(); ++i) {
                bound[layers[i].port] = i < count ? layers[i].target : "unused";
            }
            scene.target(target, "r16f").output(target);
            scene.pass(target, "contrast.composite", {{"tone", tone}, {"darkest", darkest}}, bound);
        }
    }
    Stage stage(lab, scene.json());
    stage.run();
    std::vector<Image> inputs;
    for (const Layer& layer : layers) {
        inputs.push_back(stage.read(layer.target));
    }
    for (std::size_t count = 1; count <= layers.size(); ++count) {
        for (const char* tone : tones) {
            const bool thesis = tone == tones[1];
            const std::string target = std::string(tone) + std::to_string(count);
            const double error = error_against(stage.read(target), [&](int x, int y) {
                double ratio = 0.0;
                for (std::size_t i = 1; i < count; ++i) {
                    const double scale = layers[i].scale;
                    ratio = std::max(ratio, scale == 1.0
                                                ? static_cast<double>(inputs[i].at(x, y, 0))
                                                : magnified(inputs[i], scale * (x + 0.5), scale * (y + 0.5)));
                }
                return toned(thesis, inputs[0].at(x, y, 0), ratio, darkest);
            });
            lab.add({.group = "composite",
                     .name = name_of(count, tone),
                     .samples = stage.pass(target),
                     .error = error,
                     .error_of = double_reference,
                     .ceiling = "copy of the same inputs",
                     .base = stage.pass("copy" + std::to_string(count)),
                     .goal = pass_goal});
        }
    }
}

void run_gaussian(Lab& lab) {
    SceneText scene(lab.empty_scene());
    source(scene, "in", "r16f", 0.0).output("in");
    scene.target("copy", "r16f")
        .pass("copy", "bench.copy1", {}, {{"a", "in"}, {"out", "copy"}})
        .output("copy");
    scene.target("linear", "r16f");
    scene.pass("linear", "bench.linear", {}, {{"a", "in"}, {"out", "linear"}}).output("linear");
    const std::array<double, 4> sigmas{0.0, 1.0, 4.0, 8.0};  // [pixels]
    const auto name_of = [](double sigma) { return "sigma_" + std::to_string(static_cast<int>(sigma)); };
    for (const double sigma : sigmas) {
        scene.target(name_of(sigma), "r16f").output(name_of(sigma));
        scene.pass(name_of(sigma), "filter.gaussian",
                   {{"axis", "x"}, {"sigma", sigma / lab.options().height}},
                   {{"source", "in"}, {"blurred", name_of(sigma)}});
    }
    Stage stage(lab, scene.json());
    stage.run();
    const Image in = stage.read("in");
    constexpr double linear_steps = 32.0;  // as glsl/bench/rate.frag
    for (const double sigma : sigmas) {
        const int radius = static_cast<int>(std::ceil(3.0 * sigma));
        const double error = error_against(stage.read(name_of(sigma)), [&](int x, int y) {
            double sum = 0.0;
            double weights = 0.0;
            for (int d = -radius; d <= radius; ++d) {
                const double weight = sigma > 0.0 ? std::exp(-0.5 * d * d / (sigma * sigma)) : 1.0;
                sum += weight * static_cast<double>(in.at(std::clamp(x + d, 0, in.width - 1), y, 0));
                weights += weight;
            }
            return sum / weights;
        });
        // The copy, and the linear fetches beyond its one.
        const double fetches = 2.0 * static_cast<double>(filter::make_gaussian(sigma).pairs.size());
        Samples base = stage.pass("copy");
        const Samples& linear = stage.pass("linear");
        for (std::size_t i = 0; i < base.size(); ++i) {
            base[i].time_ms += fetches / linear_steps * linear[i].time_ms;
            base[i].work_ms += fetches / linear_steps * linear[i].work_ms;
        }
        lab.add({.group = "gaussian",
                 .name = "sigma " + std::to_string(static_cast<int>(sigma)) + " pixels",
                 .samples = stage.pass(name_of(sigma)),
                 .error = error,
                 .error_of = double_reference,
                 .value = 1.0 + fetches,
                 .unit = "fetches",
                 .ceiling = "copy and as many linear fetches",
                 .base = std::move(base),
                 .goal = pass_goal});
    }
}

}  // namespace viscera::app

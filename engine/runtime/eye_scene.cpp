#include "engine/runtime/eye_scene.h"

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/eyes.h"
#include "engine/runtime/side_by_side.h"

namespace viscera {
namespace {

EyeGraph of_one_eye(Graph graph) {
    EyeGraph eyes{.graph = std::move(graph)};
    for (std::size_t p = 0; p < eyes.graph.passes.size(); ++p) {
        eyes.passes.push_back({p, -1});
    }
    return eyes;
}

[[noreturn]] void throw_all(const Scene& scene, std::span<const Fault> faults) {
    std::string text;
    for (const Fault& fault : faults) {
        text += (text.empty() ? "" : "\n") + to_string(fault);
    }
    throw Error(ErrorCode::scene, scene.file.empty() ? "scene" : scene.file.string(), text);
}

}  // namespace

EyeScene::EyeScene(const Scene& scene, const SceneEffects& effects, std::span<const ImportedTarget> imported,
                   std::span<const std::string> more_outputs, int eye_count) {
    Graph graph = build_graph(scene, effects, imported, more_outputs);
    if (eye_count == 1) {
        eyes_ = of_one_eye(std::move(graph));
        return;
    }
    // What names one eye's target in so many words is there once both eyes are.
    std::vector<std::string> of_one;
    std::erase_if(graph.outputs, [&](const std::string& name) {
        const bool written =
            std::ranges::any_of(graph.targets, [&](const TargetDesc& target) { return target.name == name; });
        if (!written && (name.ends_with(".left") || name.ends_with(".right"))) {
            of_one.push_back(name);
            return true;
        }
        return false;
    });
    std::vector<char> uses_view;
    for (const std::unique_ptr<Effect>& effect : effects.effects) {
        uses_view.push_back(effect->uses_view() ? 1 : 0);
    }
    eyes_ = expand_eyes(graph, uses_view);
    if (!eyes_.faults.empty()) {
        throw_all(scene, eyes_.faults);
    }
    if (scene.camera.stereo && scene.camera.stereo->layout == StereoLayout::side_by_side) {
        add_side_by_side(scene);
    }
    for (std::string& name : of_one) {
        if (std::ranges::find(eyes_.graph.outputs, name) == eyes_.graph.outputs.end()) {
            eyes_.graph.outputs.push_back(std::move(name));
        }
    }
}

void EyeScene::add_side_by_side(const Scene& scene) {
    Graph& graph = eyes_.graph;
    for (const std::string& name : scene.outputs) {
        const auto described = std::ranges::find(graph.targets, eye_name(name, 0), &TargetDesc::name);
        if (!eyes_.eyed.contains(name) || described == graph.targets.end() ||
            info(described->format).is_depth) {
            continue;  // shared, the host's own, or a depth, which no picture shows
        }
        TargetDesc both = *described;
        both.name = name;
        both.size.columns = 2;
        if (std::ranges::find(graph.targets, name, &TargetDesc::name) != graph.targets.end()) {
            const Fault taken{"", "", name,
                              "is shared by both eyes before each makes its own, so it cannot be the name of "
                              "both side by side, too"};
            throw_all(scene, std::span(&taken, 1));
        }
        own_.push_back(std::make_unique<SideBySideEffect>(both.format, both.clear));
        graph.targets.push_back(std::move(both));
        graph.passes.push_back({.name = "side_by_side." + name,
                                .effect = "side_by_side",
                                .ports = {{"left", eye_name(name, 0), Access::read, false, ""},
                                          {"right", eye_name(name, 1), Access::read, false, ""},
                                          {"picture", name, Access::write, false, ""}}});
        eyes_.passes.push_back({no_source, -1});
        joined_.push_back(name);
        std::erase_if(graph.outputs, [&](const std::string& output) {
            return output == eye_name(name, 0) || output == eye_name(name, 1);
        });
        graph.outputs.push_back(name);
    }
}

std::vector<std::string> EyeScene::names_of(std::string_view name) const {
    if (std::ranges::find(joined_, name) != joined_.end()) {
        return {std::string(name)};
    }
    return eyes_.names_of(name);
}

std::vector<std::string> EyeScene::outputs_of(const Scene& scene) const {
    std::vector<std::string> names;
    for (const std::string& output : scene.outputs) {
        for (std::string& name : names_of(output)) {
            names.push_back(std::move(name));
        }
    }
    return names;
}

std::vector<PassEffect> EyeScene::effects(const SceneEffects& left, const SceneEffects& right) {
    std::vector<PassEffect> all;
    std::size_t next = 0;
    for (const EyePass& origin : eyes_.passes) {
        if (origin.source == no_source) {
            all.push_back({own_[next++].get(), 1, origin});
            continue;
        }
        const SceneEffects& set = origin.eye == 1 ? right : left;
        all.push_back({set.effects[origin.source].get(), set.parameter_keys[origin.source], origin});
    }
    return all;
}

}  // namespace viscera

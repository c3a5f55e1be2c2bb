#include "engine/runtime/scene_graph.h"

#include <algorithm>
#include <map>
#include <set>

#include "engine/core/error.h"
#include "engine/core/hash.h"

namespace viscera {
namespace {

std::string names_of(const Registry& registry) {
    std::string names;
    for (const Registry::Entry& entry : registry.entries()) {
        names += (names.empty() ? "" : ", ") + entry.name;
    }
    return names;
}

std::string unknown_effect(const std::string& name, const Registry& registry) {
    std::vector<std::string> names;
    for (const Registry::Entry& entry : registry.entries()) {
        names.push_back(entry.name);
    }
    const std::string_view near = nearest_word(name, names);
    return "unknown effect '" + name + "'; " +
           (near.empty() ? "known are " + names_of(registry) : "did you mean '" + std::string(near) + "'?");
}

[[noreturn]] void throw_all(const Scene& scene, std::span<const JsonFault> faults) {
    std::string text;
    for (const JsonFault& fault : faults) {
        text +=
            (text.empty() ? "" : "\n" + scene.file.string() + ": ") + fault.pointer + ": " + fault.message;
    }
    throw Error(ErrorCode::scene, scene.file.string(), text);
}

/// What the ports of all passes that touch one name ask of its target. The first write decides.
TargetDesc describe(const Port& port, const std::string& name) {
    return {.name = name, .format = port.format, .size = port.size, .clear = port.clear};
}

void apply(const SceneTarget& given, TargetDesc& target) {
    target.format = given.format.value_or(target.format);
    target.size = given.size.value_or(target.size);
    target.clear = given.clear.value_or(target.clear);
}

}  // namespace

SceneEffects make_effects(const Scene& scene, const Registry& registry) {
    SceneEffects made;
    std::vector<JsonFault> faults;
    const std::filesystem::path base = scene.file.parent_path();
    for (const ScenePass& pass : scene.passes) {
        const Registry::Entry* entry = registry.find(pass.effect);
        if (entry == nullptr) {
            faults.push_back({pass.pointer + "/effect", unknown_effect(pass.effect, registry)});
            continue;
        }
        std::unique_ptr<Effect> effect = entry->make();
        const std::string pointer = pass.pointer + "/parameters";
        const std::size_t before = faults.size();
        read_params(
            pass.parameters, pointer, base, [&](ParamVisitor& v) { effect->visit(v); }, faults);
        if (faults.size() == before) {
            try {
                effect->validate();
            } catch (const Error& error) {
                faults.push_back({pointer + error.where(), std::string(error.message())});
            }
        }
        const std::vector<Port> ports = effect->ports();
        for (const auto& [port, target] : pass.targets) {
            const auto bound = std::ranges::find(ports, port, &Port::name);
            if (bound != ports.end() && target.empty() && !bound->optional) {
                faults.push_back({pass.pointer + "/targets/" + port,
                                  "effect '" + pass.effect + "' cannot do without port '" + port + "'"});
            } else if (bound == ports.end()) {
                std::vector<std::string> known;
                known.reserve(ports.size());
                for (const Port& p : ports) {
                    known.push_back(p.name);
                }
                const std::string_view near = nearest_word(port, known);
                faults.push_back({pass.pointer + "/targets/" + port,
                                  "effect '" + pass.effect + "' has no port '" + port + "'" +
                                      (near.empty() ? "" : "; did you mean '" + std::string(near) + "'?")});
            }
        }
        const std::string text = write_params([&](ParamVisitor& v) { effect->visit(v); }).dump();
        made.parameter_keys.push_back(
            Hash().add(std::string_view(pass.effect)).add(std::string_view(text)).value());
        made.effects.push_back(std::move(effect));
    }
    if (!faults.empty()) {
        throw_all(scene, faults);
    }
    return made;
}

Graph build_graph(const Scene& scene, const SceneEffects& effects, std::span<const ImportedTarget> imported,
                  std::span<const std::string> more_outputs) {
    Graph graph;
    graph.imported.assign(imported.begin(), imported.end());
    graph.outputs = scene.outputs;
    for (const std::string& name : more_outputs) {
        if (std::ranges::find(graph.outputs, name) == graph.outputs.end()) {
            graph.outputs.push_back(name);
        }
    }
    const auto is_imported = [&](const std::string& name) {
        return std::ranges::find(imported, name, &ImportedTarget::name) != imported.end();
    };
    std::map<std::string, TargetDesc> described;
    std::vector<std::string> order;
    for (std::size_t i = 0; i < scene.passes.size(); ++i) {
        const ScenePass& pass = scene.passes[i];
        GraphPass node{.name = pass.name, .effect = pass.effect, .enabled = pass.enabled};
        for (const Port& port : effects.effects[i]->ports()) {
            const auto given = pass.targets.find(port.name);
            const std::string target = given == pass.targets.end() ? port.target : given->second;
            if (target.empty()) {
                continue;  // an optional port that nobody binds
            }
            node.ports.push_back({port.name, target, port.access, port.optional, port.passthrough});
            if (port.access == Access::write && !is_imported(target) && !described.contains(target)) {
                described.emplace(target, describe(port, target));
                order.push_back(target);
            }
        }
        graph.passes.push_back(std::move(node));
    }
    for (const SceneTarget& given : scene.targets) {
        const auto found = described.find(given.name);
        if (found == described.end()) {
            throw Error(ErrorCode::scene, scene.file.string(),
                        "/targets/" + given.name + ": no pass writes this target");
        }
        apply(given, found->second);
    }
    for (const std::string& name : order) {
        graph.targets.push_back(described.at(name));
    }
    return graph;
}

Plan compile_scene(const Scene& scene, const Graph& graph, int width, int height, int max_size) {
    try {
        return compile_or_throw(graph, width, height, max_size);
    } catch (const Error& error) {
        const std::string where = scene.file.empty() ? "scene" : scene.file.string();
        throw Error(error.code(), where, std::string(error.message()));
    }
}

}  // namespace viscera

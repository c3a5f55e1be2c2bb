#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/graph.h"
#include "engine/core/plan.h"
#include "engine/core/scene.h"
#include "engine/runtime/effect.h"

namespace viscera {

/// The effects of a scene with their parameters read: one per pass, in the scene's order. Disabled passes
/// have theirs too.
struct SceneEffects {
    std::vector<std::unique_ptr<Effect>> effects;
    std::vector<std::uint64_t> parameter_keys;  ///< hash of each effect's parameters
};

/// Makes each pass's effect and reads its parameters. Every fault of every pass (unknown effect with 'did you
/// mean', bad parameter, unknown port) is listed in one Error(scene).
[[nodiscard]] SceneEffects make_effects(const Scene& scene, const Registry& registry);

/// The scene as a graph: ports bound to their default or given targets, targets described by the effects that
/// write them and by what the scene says. `outputs`: names wanted besides the scene's own. Pure.
[[nodiscard]] Graph build_graph(const Scene& scene, const SceneEffects& effects,
                                std::span<const ImportedTarget> imported,
                                std::span<const std::string> more_outputs = {});

/// compile_or_throw() of a scene's graph, whose errors name the scene's file.
[[nodiscard]] Plan compile_scene(const Scene& scene, const Graph& graph, int width, int height,
                                 int max_size = 16384);

}  // namespace viscera

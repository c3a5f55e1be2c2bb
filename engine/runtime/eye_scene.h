#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/core/eye_graph.h"
#include "engine/runtime/scene_graph.h"

namespace viscera {

/// The effect of one pass of a plan.
struct PassEffect {
    Effect* effect = nullptr;
    std::uint64_t parameters_key = 0;
    EyePass origin;  ///< source: the scene's pass
};

/// A scene's passes for frames of one or two eyes, and the effects that draw them. The effects of a frame of
/// one eye, or of the left one, are the scene's own; the right eye's are made here.
class EyeScene {
  public:
    /// What `origin.source` is for a pass that no scene names: the one that puts two pictures side by side.
    static constexpr std::size_t no_source = static_cast<std::size_t>(-1);

    /// `eye_count`: 1 or 2. `more_outputs`: names wanted besides the scene's own, as the scene calls them.
    /// Throws Error(scene) when the graph of two eyes has faults.
    EyeScene(const Scene& scene, const SceneEffects& effects, std::span<const ImportedTarget> imported,
             std::span<const std::string> more_outputs, int eye_count);

    [[nodiscard]] const Graph& graph() const { return eyes_.graph; }
    /// What the scene calls `name` is called so in this graph.
    [[nodiscard]] std::vector<std::string> names_of(std::string_view name) const;
    /// Names of the scene's outputs.
    [[nodiscard]] std::vector<std::string> outputs_of(const Scene& scene) const;
    /// Effects of graph().passes. `left`: the scene's; `right`: another set, used for right eyes. The object
    /// keeps the effects that no scene names.
    [[nodiscard]] std::vector<PassEffect> effects(const SceneEffects& left, const SceneEffects& right);

  private:
    void add_side_by_side(const Scene& scene);

    EyeGraph eyes_;
    std::vector<std::string> joined_;  ///< outputs that are one picture of both eyes
    std::vector<std::unique_ptr<Effect>> own_;
};

}  // namespace viscera

#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/runtime/eye_scene.h"
#include "engine/runtime/renderer.h"

namespace viscera {

class Executor;

/// What is read back besides the scene's outputs, by the scene's names. It is kept to the end of each frame.
struct ReadBack {
    DumpRequest dump;
    std::vector<std::string> kept;
    std::vector<std::string> watched;
};

/// A scene with its effects, and the plan that an executor was given for the frames that are rendered.
class LoadedScene {
  public:
    LoadedScene(const Registry& registry, int max_texture_size)
        : registry_(registry), max_texture_size_(max_texture_size) {}

    /// Takes a scene, or throws Error(scene) and keeps the one it had.
    void set(Scene scene, std::span<const ImportedTarget> imported);
    [[nodiscard]] const Scene& scene() const { return scene_; }
    /// Targets that the frames bring, as set() was told.
    [[nodiscard]] const std::vector<ImportedTarget>& expected() const { return expected_; }
    /// Whether what a frame shows depends on the frames before it.
    [[nodiscard]] bool keeps_state() const;

    /// The scene with one parameter changed, and which pass that is. Throws Error(scene).
    struct Edited {
        Scene scene;
        std::size_t pass = 0;
    };
    [[nodiscard]] Edited edited(std::string_view pass, std::string_view pointer,
                                const nlohmann::json& value) const;
    /// Takes it and replaces that pass's effect where it stands, so that what other passes have drawn stays.
    /// False, and nothing is done: the graph is another now.
    [[nodiscard]] bool replace(Edited& edited, Executor& executor);

    /// Gives the executor a plan for such frames unless it has it.
    void plan_for(const Frame& frame, const ReadBack& read_back, Executor& executor);
    /// Has the next frame planned again: what is read back, or how it is drawn, has changed.
    void replan() { planned_ = false; }
    /// What of `ReadBack::dump` the plan holds, as its targets are called.
    [[nodiscard]] const std::vector<std::string>& dumped() const { return dumped_; }
    /// What the plan calls a target of the scene.
    [[nodiscard]] std::vector<std::string> names_of(std::string_view name) const;

  private:
    [[nodiscard]] glm::ivec2 planned_size(const Frame& frame) const;

    const Registry& registry_;
    int max_texture_size_;
    Scene scene_;
    SceneEffects effects_;               ///< of the only or the left eye, and of what both share
    SceneEffects right_effects_;         ///< of the right eye; empty before the first frame of two
    std::optional<EyeScene> eye_scene_;  ///< of the plan
    std::vector<ImportedTarget> expected_;
    std::vector<ImportedTarget> imported_;  ///< as the last frame brought
    std::vector<std::string> dumped_;
    bool has_history_ = false;
    bool planned_ = false;
    bool same_scene_ = false;  ///< as when the last plan was made
    int planned_eyes_ = 1;
};

}  // namespace viscera

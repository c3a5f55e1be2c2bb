#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/core/image_compare.h"
#include "samples/viscera/bench/lab.h"

namespace viscera::app {

/// One way to cast the rays of a scene.
struct Variant {
    std::string name;
    nlohmann::json changes = nlohmann::json::object();  ///< merged into the scene's parameters; null removes
    std::string effect = "volume.ray_cast";
};

/// Pass and target of the i-th variant of a scene.
[[nodiscard]] std::string key(std::size_t i);

/// A scene with one ray caster, shown in many ways at once: each variant is a pass with a target of its own.
class VolumeScene {
  public:
    /// assets/scenes/`name`.json. Throws Error(file).
    VolumeScene(const Lab& lab, std::string_view name);

    /// For all variants. `changes` as in Variant.
    void change(const nlohmann::json& changes) { parameters_.merge_patch(changes); }
    void view(const nlohmann::json& camera) { scene_["camera"] = camera; }
    /// `scale` of the lab's resolution.
    [[nodiscard]] nlohmann::json json(std::span<const Variant> variants, std::string_view format,
                                      double scale = 1.0) const;

  private:
    nlohmann::json scene_;
    nlohmann::json parameters_;
    int width_;
    int height_;
};

/// Changes that make the most exact picture there is of composition: full-precision weights, a sixteenth of
/// a voxel, two Gauss points, an interpolated table, no early end. Projections and surfaces are solved in
/// each cell instead.
[[nodiscard]] nlohmann::json exact_composite();
[[nodiscard]] nlohmann::json exact_cells();
inline constexpr std::string_view exact_name = "own exact picture";

/// How a variant differs from the exact picture, and how many samples it takes.
struct PictureQuality {
    CompareResult difference;
    double samples_per_pixel = 0.0;
};
/// In float targets, at `scale` of the lab's resolution, so that exact pictures come in time. `exact`:
/// changes to each variant that make it exact; null: the last exact picture will do.
struct Judged {
    Variant variant;
    nlohmann::json exact;
};
[[nodiscard]] std::vector<PictureQuality> judge(Lab& lab, const VolumeScene& scene,
                                                std::span<const Judged> judged, double scale);

/// Moves the eye by a billionth of a millimetre a frame, so that nothing is cached and nothing changes.
void nudge(Frame& frame);

}  // namespace viscera::app

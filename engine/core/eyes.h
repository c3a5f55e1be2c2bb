#pragma once

#include <array>
#include <string>
#include <string_view>

#include "engine/core/camera.h"

namespace viscera {

/// The views of a frame: one, or left and right.
struct Eyes {
    std::array<View, 2> views{};
    int count = 1;
};

/// Views of a camera at a time: two when it has `stereo`. Throws as make_view() does, and for an eye distance
/// or a convergence that is no length.
[[nodiscard]] Eyes make_eyes(const CameraParams& camera, double aspect, double time_s = 0.0);

/// The view moved by `offset_mm` to its right, its frustum sheared so that the plane at `convergence_mm`
/// stays where it is in the picture. Axes stay parallel: eyes that turn inward would give points off the
/// horizon another height in each picture. A point at distance z along the view moves to the left by `offset
/// * P00 / 2 * (1/z - 1/convergence)` of the picture's width (P00: the projection's first element).
/// Orthographic: the rays slant so that they meet at `convergence_mm`, and it moves by `offset * P00 / 2 *
/// (1 - z/convergence)`. c_arm: the source moves, the detector does not.
[[nodiscard]] View shifted_view(const View& view, double offset_mm, double convergence_mm);

/// "left" or "right".
[[nodiscard]] std::string_view eye_word(int eye);
/// What a target or a pass that each eye has is called: "volume.colour.left".
[[nodiscard]] std::string eye_name(std::string_view name, int eye);

}  // namespace viscera

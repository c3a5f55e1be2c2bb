#pragma once

namespace viscera {

/// How finely one frame is drawn. The default is full quality; less is for frames that must come in time.
struct Quality {
    /// >= 1: effects that take steps along rays make them this many times as long.
    double step_factor = 1.0;
    /// In (0, 1]: share of the frame's width and height at which its targets are drawn; what is presented is
    /// filtered up to the viewport. Frames with imported textures, and scenes that read targets of the frame
    /// before, are drawn in full size whatever this says.
    double resolution = 1.0;

    [[nodiscard]] bool full() const { return step_factor == 1.0 && resolution == 1.0; }
    bool operator==(const Quality&) const = default;
};

}  // namespace viscera

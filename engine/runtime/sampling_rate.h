#pragma once

#include <array>
#include <optional>

#include "engine/runtime/quality.h"

namespace viscera {

struct SamplingRateOptions {
    double target_ms = 33.0;  ///< time a frame may take while the user moves, > 0
    double delay_ms = 150.0;  ///< stillness after which quality returns, >= 0
    /// No frame is drawn worse than this.
    Quality minimum{.step_factor = 3.0, .resolution = 0.25};
};

/// What a host knows when it asks for the next frame's quality.
struct FrameObservation {
    /// What the frame before took to draw [ms], up to the end of the GPU's work and without the wait for the
    /// display. None when nothing was drawn anew, or when the time says nothing about the next frame (files
    /// were read, shaders compiled).
    std::optional<double> draw_ms{};
    double interval_ms = 0.0;  ///< wall clock since the last observation
    bool moved = false;        ///< camera, parameters or size are others than in the frame before
};

/// Samples that a quality takes, as a share of full quality: resolution^2 / step_factor, in (0, 1].
[[nodiscard]] double share_of(const Quality& quality);

/// The quality that takes this share of the samples, no worse than `minimum`. The step grows first, to
/// minimum.step_factor; only then does the resolution shrink, in sixteenths, so that targets change their
/// size rarely.
[[nodiscard]] Quality quality_for(double share, const Quality& minimum);

/// Chooses step and resolution so that frames come in time while the user moves and are drawn in full when
/// all is still.
///
/// Moving: time is taken as proportional to samples, by the median of the last three frames, so that one
/// frame out of line changes nothing. Within 0.75 to 1.1 of the target the quality stays as it is; above, the
/// share of samples falls at once to what 0.9 of the target allows; below, it grows by the square root of
/// what is missing. Still: after the delay the share doubles from frame to frame up to full quality. In
/// either case it at most doubles from one frame to the next (resolution: at most 1.8 times), so the way back
/// from the default minimum takes six frames, the last of which alone costs half. It may fall by any factor,
/// as happens when movement begins.
class SamplingRateManager {
  public:
    /// Throws Error(usage) for options out of range.
    explicit SamplingRateManager(const SamplingRateOptions& options = {});

    /// Quality of the next frame. Times that are not finite or not positive are left out.
    [[nodiscard]] Quality next(const FrameObservation& seen);

  private:
    [[nodiscard]] double controlled(double share) const;

    SamplingRateOptions options_;
    double share_ = 1.0;         ///< of the frame before
    double moving_share_ = 1.0;  ///< of the last frame that moved
    double still_ms_ = 0.0;
    /// What a frame of full quality would have taken by the last measurements, newest last; 0: unknown.
    std::array<double, 3> full_ms_{};
};

}  // namespace viscera

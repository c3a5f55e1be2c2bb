#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "engine/gl/functions.h"
#include "engine/runtime/frame.h"
#include "engine/runtime/report.h"
#include "engine/runtime/sampling_rate.h"

namespace viscera::app {

/// Keeps a window's frames on time while its user moves something: watches what changes and what frames take.
class InteractiveRate {
  public:
    /// The context of `proc` must be current. Throws Error(usage) for a target that is not above 0 ms.
    InteractiveRate(double target_ms, ProcAddress proc);

    /// Quality of the frame that is about to be drawn. `revision`: another whenever parameters have changed.
    [[nodiscard]] Quality begin(const Frame& frame, std::uint64_t revision);
    /// That frame's commands have been given; waits for them, so that the display's refresh is not measured.
    void end(const FrameReport& report);

  private:
    using Clock = std::chrono::steady_clock;
    /// What a picture shows, from where.
    struct Sight {
        glm::dmat4 view_projection{0.0};
        int width = 0;
        int height = 0;
        std::uint64_t revision = 0;
        bool operator==(const Sight&) const = default;
    };

    SamplingRateManager manager_;
    std::unique_ptr<const gl::Functions> gl_;
    std::optional<Sight> sight_;
    std::optional<double> draw_ms_;
    Clock::time_point begun_ = Clock::now();
    bool first_ = true;
};

}  // namespace viscera::app

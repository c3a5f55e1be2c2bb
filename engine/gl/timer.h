#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>

#include "engine/gl/handle.h"

namespace viscera::gl {

/// GPU time between begin() and end(), known some frames later, without ever waiting. It uses timestamps, so
/// that it may be nested and never collides with a GL_TIME_ELAPSED query of the host's. Software renderers
/// report times of no meaning (Capabilities::gpu_timers()).
class GpuTimer {
  public:
    explicit GpuTimer(const Functions& gl);

    /// Measures nothing when all results of the ring are still outstanding.
    void begin();
    void end();
    /// The newest measurement that has come back [ms]; none before the first.
    [[nodiscard]] std::optional<double> latest_ms();

  private:
    static constexpr std::size_t ring_size = 8;
    struct Slot {
        QueryHandle begin;
        QueryHandle end;
    };
    const Functions* gl_;
    std::array<Slot, ring_size> slots_;
    std::size_t first_ = 0;  ///< oldest outstanding
    std::size_t count_ = 0;
    bool running_ = false;
    std::optional<double> latest_ms_;
};

/// Wall-clock time since it was made.
class CpuTimer {
  public:
    [[nodiscard]] double milliseconds() const {
        return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
    }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

}  // namespace viscera::gl

#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <optional>

#include "engine/gl/handle.h"

namespace viscera::gl {

/// GPU time between begin() and end(), known some frames later, without ever waiting. It uses timestamps, so
/// that it may be nested and never collides with a GL_TIME_ELAPSED query of the host's.
///
/// Software renderers report times of no meaning: reliable() is then false.
class GpuTimer {
  public:
    /// `software`: whether the context renders on the CPU.
    GpuTimer(const Functions& gl, bool software);

    /// Measures nothing when all results of the ring are still outstanding.
    void begin();
    void end();
    /// The newest measurement that has come back [ms]; none before the first.
    [[nodiscard]] std::optional<double> latest_ms();
    [[nodiscard]] std::size_t outstanding() const { return count_; }
    [[nodiscard]] bool reliable() const { return reliable_; }

    static constexpr std::size_t ring_size = 8;

  private:
    struct Slot {
        QueryHandle begin;
        QueryHandle end;
    };
    const Functions* gl_;
    std::array<Slot, ring_size> slots_;
    std::size_t first_ = 0;  ///< oldest outstanding
    std::size_t count_ = 0;
    bool running_ = false;
    bool reliable_ = true;
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

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "engine/core/pixel_format.h"
#include "engine/core/schedule.h"

namespace viscera {

/// By which kind of shader a pass made its picture.
enum class DrawPath { fragment, compute };
[[nodiscard]] std::string_view to_string(DrawPath path);

/// What one pass did in one frame.
struct PassReport {
    std::string name;
    std::string effect;
    int eye = -1;  ///< 0 left, 1 right; -1: once for the frame
    PassStatus status = PassStatus::culled;
    std::string reason;
    std::optional<DrawPath> path;  ///< none when nothing was drawn
    double cpu_ms = 0.0;           ///< prepare and draw on the calling thread
    std::optional<double>
        gpu_ms;  ///< the newest timer query that has come back; none on software renderers, whose timers lie
};

/// What one dumped target held.
struct TargetReport {
    std::string name;
    PixelFormat format = PixelFormat::r16f;
    int width = 0;
    int height = 0;
    std::string file;  ///< empty when nothing was written
    double min = 0.0;  ///< over finite values; 0 when there is none
    double max = 0.0;
    std::uint64_t nan = 0;
    std::uint64_t inf = 0;
};

/// Told when a pass begins and when all its commands have been given. It may wait for them (glFinish), which
/// is how passes are measured on software renderers, but must change no other state.
using PassObserver = std::function<void(std::string_view pass, bool begins)>;

struct FrameReport {
    std::uint64_t index = 0;
    double time_s = 0.0;
    double cpu_ms = 0.0;  ///< render() on the calling thread
    std::vector<PassReport> passes;
    std::vector<TargetReport> targets;
};

[[nodiscard]] nlohmann::json to_json(const FrameReport& report);

}  // namespace viscera

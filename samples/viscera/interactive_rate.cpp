#include "samples/viscera/interactive_rate.h"

#include <algorithm>
#include <utility>

namespace viscera::app {
namespace {

double milliseconds(std::chrono::steady_clock::duration time) {
    return std::chrono::duration<double, std::milli>(time).count();
}

}  // namespace

InteractiveRate::InteractiveRate(double target_ms, ProcAddress proc)
    : manager_({.target_ms = target_ms}), gl_(gl::Functions::load(std::move(proc))) {}

Quality InteractiveRate::begin(const Frame& frame, std::uint64_t revision) {
    const Sight sight{frame.eye().view_projection(), frame.width, frame.height, revision};
    const bool moved = sight_ && *sight_ != sight;
    sight_ = sight;
    const Clock::time_point now = Clock::now();
    const double interval_ms = milliseconds(now - std::exchange(begun_, now));
    return manager_.next({.draw_ms = draw_ms_, .interval_ms = interval_ms, .moved = moved});
}

void InteractiveRate::end(const FrameReport& report) {
    gl_->Finish();
    const bool drawn = std::ranges::any_of(report.passes, [](const PassReport& pass) {
        return pass.status == PassStatus::run || pass.status == PassStatus::reduced;
    });
    draw_ms_.reset();
    // The first frame reads files and compiles shaders.
    if (!std::exchange(first_, false) && drawn) {
        draw_ms_ = milliseconds(Clock::now() - begun_);
    }
}

}  // namespace viscera::app

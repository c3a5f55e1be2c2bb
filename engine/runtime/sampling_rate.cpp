#include "engine/runtime/sampling_rate.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace viscera {
namespace {

constexpr double lowest = 0.75;  // of the target: below, the share grows
constexpr double highest = 1.1;  // above, it falls
constexpr double aim = 0.9;
constexpr double largest_growth = 2.0;
constexpr double resolution_steps = 16.0;

bool is_time(double ms) {
    return std::isfinite(ms) && ms > 0.0;
}

void refuse_unless(bool good, const char* message) {
    if (!good) {
        throw Error(ErrorCode::usage, "sampling rate", message);
    }
}

}  // namespace

double share_of(const Quality& quality) {
    return quality.resolution * quality.resolution / quality.step_factor;
}

Quality quality_for(double share, const Quality& minimum) {
    const double wanted = std::clamp(std::sqrt(share * minimum.step_factor), minimum.resolution, 1.0);
    // A hair's breadth below a sixteenth is that sixteenth; where the step cannot make up for the rest, none
    // is.
    const double sixteenths =
        std::max(std::floor(wanted * resolution_steps + 1e-9) / resolution_steps, minimum.resolution);
    const double resolution = sixteenths * sixteenths >= share ? std::min(sixteenths, 1.0) : wanted;
    return {.step_factor = std::clamp(resolution * resolution / share, 1.0, minimum.step_factor),
            .resolution = resolution};
}

SamplingRateManager::SamplingRateManager(const SamplingRateOptions& options) : options_(options) {
    const Quality& minimum = options.minimum;
    refuse_unless(is_time(options.target_ms), "the target must be above 0 ms");
    refuse_unless(std::isfinite(options.delay_ms) && options.delay_ms >= 0.0,
                  "the delay must not be negative");
    refuse_unless(std::isfinite(minimum.step_factor) && minimum.step_factor >= 1.0,
                  "the largest step factor must be at least 1");
    refuse_unless(minimum.resolution > 0.0 && minimum.resolution <= 1.0,
                  "the least resolution must be in (0, 1]");
}

Quality SamplingRateManager::next(const FrameObservation& seen) {
    if (seen.draw_ms && is_time(*seen.draw_ms)) {
        std::rotate(full_ms_.begin(), full_ms_.begin() + 1, full_ms_.end());
        full_ms_.back() = *seen.draw_ms / share_;
    }
    if (seen.moved) {
        still_ms_ = 0.0;
        moving_share_ = controlled(moving_share_);
        share_ = std::min(moving_share_, largest_growth * share_);
    } else {
        still_ms_ += is_time(seen.interval_ms) ? seen.interval_ms : 0.0;
        if (still_ms_ >= options_.delay_ms) {
            share_ = std::min(1.0, largest_growth * share_);
        }
    }
    return quality_for(share_, options_.minimum);
}

double SamplingRateManager::controlled(double share) const {
    const auto [a, b, c] = full_ms_;
    const double median = std::max(std::min(a, b), std::min(std::max(a, b), c));
    const double expected = (median > 0.0 ? median : c) * share / options_.target_ms;
    if (expected == 0.0) {
        return share;  // nothing is known yet
    }
    if (expected > highest) {
        share *= aim / expected;
    } else if (expected < lowest) {
        share *= std::min(largest_growth, std::sqrt(aim / expected));
    }
    return std::clamp(share, share_of(options_.minimum), 1.0);
}

}  // namespace viscera

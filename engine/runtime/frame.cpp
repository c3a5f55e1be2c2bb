#include "engine/runtime/frame.h"

#include <bit>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/hash.h"

namespace viscera {
namespace {

/// Of the content, not a count: two objects, or copies of one, must not give different arrays one version.
std::uint64_t version_of(std::span<const float> values) {
    std::uint64_t state = values.size();
    for (const float value : values) {
        state = (state ^ std::bit_cast<std::uint32_t>(value)) * 0x9e3779b97f4a7c15ULL;
        state ^= state >> 32;
    }
    return Hash().add(state).value();
}

}  // namespace

void HostValues::set(std::string_view name, std::span<const float> values) {
    auto found = entries_.find(name);
    if (found == entries_.end()) {
        found = entries_.emplace(std::string(name), Entry{}).first;
    }
    found->second.values.assign(values.begin(), values.end());
    found->second.version = version_of(values);
}

void HostValues::erase(std::string_view name) {
    const auto found = entries_.find(name);
    if (found != entries_.end()) {
        entries_.erase(found);
    }
}

const HostValues::Entry* HostValues::find(std::string_view name) const {
    const auto found = entries_.find(name);
    return found == entries_.end() ? nullptr : &found->second;
}

void check_frame(const Frame& frame) {
    const auto refuse = [](const char* why) { throw Error(ErrorCode::usage, "frame", why); };
    if (frame.width < 1 || frame.height < 1) {
        refuse("needs a width and a height of at least 1 pixel");
    }
    if (frame.eye_count != 1 && frame.eye_count != 2) {
        refuse("has one eye or two");
    }
    if (frame.eye_index != 0) {
        refuse("eye_index is the renderer's own");
    }
    // Written so that NaN is refused, too.
    if (!(frame.quality.step_factor >= 1.0 && std::isfinite(frame.quality.step_factor)) ||
        !(frame.quality.resolution > 0.0 && frame.quality.resolution <= 1.0)) {
        refuse("needs a step factor of at least 1 and a resolution in (0, 1]");
    }
}

}  // namespace viscera

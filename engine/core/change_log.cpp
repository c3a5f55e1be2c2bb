#include "engine/core/change_log.h"

namespace viscera {

void ChangeLog::note(std::uint64_t key, std::uint64_t base, const PixelRegion& region) {
    // The same key again says the same: a second entry would only push out another.
    const auto known = std::ranges::find(entries_, key, &Entry::key);
    if (known != entries_.end()) {
        *known = {key, base, region};
        return;
    }
    entries_[next_] = {key, base, region};
    next_ = (next_ + 1) % capacity;
}

std::optional<PixelRegion> ChangeLog::between(std::uint64_t older, std::uint64_t newer) const {
    PixelRegion changed;
    for (int step = 0; step <= max_steps; ++step) {
        if (newer == older) {
            return changed;
        }
        const auto entry = std::ranges::find(entries_, newer, &Entry::key);
        if (entry == entries_.end() || newer == 0) {
            break;
        }
        changed.add(entry->region);
        newer = entry->base;
    }
    return std::nullopt;
}

}  // namespace viscera

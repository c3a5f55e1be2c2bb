#include "effects/tissue/drop_ring.h"

#include <algorithm>

namespace viscera::tissue {

void DropRing::clear() {
    lives_.clear();
    came_.clear();
    head_ = 0;
    ++version_;
}

DropRange DropRing::add(std::int64_t count, std::int64_t capacity) {
    lives_.resize(static_cast<std::size_t>(capacity / group_size), 0);
    came_.resize(lives_.size(), 0);
    DropRange evicted{head_, 0};
    for (std::int64_t left = count; left > 0; --left, ++head_) {
        const std::int64_t place = head_ % capacity;
        const auto group = static_cast<std::size_t>(place / group_size);
        const auto bit = static_cast<std::uint16_t>(1U << (place % group_size));
        if ((lives_[group] & bit) != 0) {
            evicted.first = evicted.count > 0 ? evicted.first : head_;
            evicted.count = head_ + 1 - evicted.first;
        }
        lives_[group] |= bit;
        came_[group] = asked_;
    }
    version_ += count > 0 ? 1 : 0;
    return evicted;
}

void DropRing::hear(std::uint64_t tag, std::span<const std::byte> lives) {
    bool changed = false;
    const std::size_t count = std::min(lives.size() / 2, lives_.size());
    for (std::size_t i = 0; i < count; ++i) {
        if (came_[i] < tag) {
            const auto before = lives_[i];
            lives_[i] &= static_cast<std::uint16_t>(std::to_integer<unsigned>(lives[2 * i]) |
                                                    std::to_integer<unsigned>(lives[2 * i + 1]) << 8U);
            changed = changed || lives_[i] != before;
        }
    }
    version_ += changed ? 1 : 0;
}

}  // namespace viscera::tissue

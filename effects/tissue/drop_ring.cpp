#include "effects/tissue/drop_ring.h"

#include <algorithm>

namespace viscera::tissue {

void DropRing::clear() {
    came_.clear();
    head_ = 0;
    stale_ = false;
    list();
}

DropRange DropRing::add(std::int64_t count, std::int64_t capacity) {
    const auto groups = static_cast<std::size_t>(capacity / group_size);
    came_.resize(groups, nobody);
    DropRange evicted{head_, 0};
    bool changed = false;
    const std::int64_t end = head_ + count;
    for (std::int64_t at = head_; at < end;) {
        const std::int64_t next = std::min((at / group_size + 1) * group_size, end);
        std::uint64_t& last = came_[static_cast<std::size_t>(at / group_size) % groups];
        if (at % group_size == 0) {
            stale_ = last != nobody;
        }
        if (stale_) {
            evicted.first = evicted.count > 0 ? evicted.first : at;
            evicted.count = next - evicted.first;
        }
        changed = changed || last == nobody;
        last = asked_;
        at = next;
    }
    head_ = end;
    if (changed) {
        list();
    }
    return evicted;
}

void DropRing::hear(std::uint64_t tag, std::span<const std::byte> lives) {
    bool changed = false;
    const std::size_t count = std::min(lives.size(), came_.size());
    for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t& last = came_[i];
        if (lives[i] == std::byte{0} && last != nobody && last < tag) {
            last = nobody;
            changed = true;
        }
    }
    if (changed) {
        list();
    }
}

void DropRing::list() {
    groups_.clear();
    for (std::size_t i = 0; i < came_.size(); ++i) {
        if (came_[i] != nobody) {
            groups_.push_back(static_cast<int>(i));
        }
    }
    ++version_;
}

}  // namespace viscera::tissue

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace viscera::tissue {

/// Drops [first, first + count) of the ring.
struct DropRange {
    std::int64_t first = 0;
    std::int64_t count = 0;
};

/// Which drops of the ring may live, by groups of 16 next to each other. New ones are given a place here;
/// when they have gone, the GPU tells some frames later. Until then their groups are drawn: what is late
/// costs time and changes no picture.
class DropRing {
  public:
    static constexpr std::int64_t group_size = 16;  ///< as glsl/tissue/drop_ring.glsl

    /// None lives. What was asked before is answered in vain.
    void clear();
    /// Makes room for `count` new drops, no more than `capacity`, a multiple of a group's size that stays
    /// until clear(). Returns those in their places that may still live; others among them do not.
    DropRange add(std::int64_t count, std::int64_t capacity);
    /// Place of the next new drop, from 0 on without end: the ring's size must be taken off.
    [[nodiscard]] std::int64_t head() const { return head_; }

    /// A tag for a question to the GPU about all that was added up to now.
    [[nodiscard]] std::uint64_t ask() { return ++asked_; }
    /// An answer: a byte for each group, 0 where no drop lives.
    void hear(std::uint64_t tag, std::span<const std::byte> lives);

    /// Numbers of the groups that may hold a living drop, rising.
    [[nodiscard]] std::span<const int> groups() const { return groups_; }
    /// Another one after each change of groups(); never 0.
    [[nodiscard]] std::uint64_t version() const { return version_; }

  private:
    static constexpr std::uint64_t nobody = ~std::uint64_t{0};
    void list();

    std::vector<std::uint64_t> came_;  ///< by group: questions before its last drop; `nobody`: none lives
    std::vector<int> groups_;
    std::int64_t head_ = 0;
    bool stale_ = false;  ///< in the group of the head older drops may live from there on
    std::uint64_t asked_ = 0;
    std::uint64_t version_ = 1;
};

}  // namespace viscera::tissue

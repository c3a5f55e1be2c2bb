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
/// when they have gone, the GPU tells some frames later. Until then they are drawn: what is late costs time
/// and changes no picture.
class DropRing {
  public:
    static constexpr std::int64_t group_size = 16;  ///< as glsl/tissue/drop_ring.glsl

    /// None lives. What was asked before is answered in vain.
    void clear();
    /// Makes room for `count` new drops, no more than `capacity`, a multiple of a group's size that stays
    /// until clear(). Returns the run of places among theirs in which others may still live.
    DropRange add(std::int64_t count, std::int64_t capacity);
    /// Place of the next new drop, from 0 on without end: the ring's size must be taken off.
    [[nodiscard]] std::int64_t head() const { return head_; }

    /// A tag for a question to the GPU about all that was added up to now.
    [[nodiscard]] std::uint64_t ask() { return ++asked_; }
    /// An answer: two bytes for each group, the lower first, whose bits say which of its drops live.
    void hear(std::uint64_t tag, std::span<const std::byte> lives);

    /// For each group which of its drops may live, a bit for each.
    [[nodiscard]] std::span<const std::uint16_t> lives() const { return lives_; }
    /// Another one after each change of lives(); never 0.
    [[nodiscard]] std::uint64_t version() const { return version_; }

  private:
    std::vector<std::uint16_t> lives_;  ///< see lives()
    std::vector<std::uint64_t> came_;   ///< by group: questions that were asked before its last drop
    std::int64_t head_ = 0;
    std::uint64_t asked_ = 0;
    std::uint64_t version_ = 1;
};

}  // namespace viscera::tissue

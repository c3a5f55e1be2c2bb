#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/core/pixel_region.h"

namespace viscera {

/// Remembers of the last updates where each picture differs from the one that it was made of, so that a
/// texture that holds an older picture is brought up to date by copying that part only. Pictures are named by
/// their content keys (engine/core/schedule.h). Allocates nothing.
class ChangeLog {
  public:
    /// Picture `key` is picture `base` with something else in `region`.
    void note(std::uint64_t key, std::uint64_t base, const PixelRegion& region);
    /// The part outside which picture `newer` is as `older`; none: not known.
    [[nodiscard]] std::optional<PixelRegion> between(std::uint64_t older, std::uint64_t newer) const;

  private:
    struct Entry {
        std::uint64_t key = 0;
        std::uint64_t base = 0;
        PixelRegion region;
    };
    // Two textures take turns, so two steps back are what is asked for; the rest serves scenes with many
    // such targets and chains of passes.
    static constexpr std::size_t capacity = 64;
    static constexpr int max_steps = 8;

    std::array<Entry, capacity> entries_{};
    std::size_t next_ = 0;
};

}  // namespace viscera

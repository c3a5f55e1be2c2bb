#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "engine/core/pixel_rect.h"

namespace viscera {

/// Some pixels of a target: up to 16 rectangles that do not overlap. What is added beyond that, or overlaps,
/// is merged into bounding rectangles, so a region may hold more than was added but never less. A value of
/// fixed size, which allocates nothing.
class PixelRegion {
  public:
    static constexpr std::size_t capacity = 16;

    PixelRegion() = default;
    /// Of one rectangle; none when it is empty.
    PixelRegion(const PixelRect& rect) { add(rect); }  // NOLINT(google-explicit-constructor): it is one

    void add(PixelRect rect);
    void add(const PixelRegion& region);

    /// In no particular order; none is empty and no two overlap.
    [[nodiscard]] std::span<const PixelRect> rects() const { return {rects_.data(), count_}; }
    [[nodiscard]] bool empty() const { return count_ == 0; }
    /// The smallest rectangle around all.
    [[nodiscard]] PixelRect bounds() const;
    /// [pixels]
    [[nodiscard]] std::int64_t area() const;
    /// Whether one of the rectangles holds all of `rect`.
    [[nodiscard]] bool covers(const PixelRect& rect) const;
    /// The part that lies on a target of this size [pixels].
    [[nodiscard]] PixelRegion confined(int width, int height) const;

  private:
    void remove(std::size_t index);
    [[nodiscard]] PixelRect take_cheapest(const PixelRect& rect);

    std::array<PixelRect, capacity> rects_{};
    std::size_t count_ = 0;
};

}  // namespace viscera

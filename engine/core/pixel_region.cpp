#include "engine/core/pixel_region.h"

#include <limits>

namespace viscera {

void PixelRegion::add(PixelRect rect) {
    if (rect.empty() || covers(rect)) {
        return;
    }
    // Each merge may make it meet others that it had missed before.
    for (;;) {
        const auto found =
            std::ranges::find_if(rects(), [&](const PixelRect& other) { return overlap(rect, other); });
        if (found != rects().end()) {
            rect = around(rect, *found);
            remove(static_cast<std::size_t>(found - rects().begin()));
        } else if (count_ == capacity) {
            rect = take_cheapest(rect);
        } else {
            break;
        }
    }
    rects_[count_++] = rect;
}

/// Merges the two of all rectangles, `rect` included, that gain the fewest pixels by it. Returns what is left
/// to add: the merged rectangle, or `rect` with the merged one in place of another.
PixelRect PixelRegion::take_cheapest(const PixelRect& rect) {
    const auto gain = [](const PixelRect& a, const PixelRect& b) {
        return around(a, b).area() - a.area() - b.area();
    };
    std::size_t first = 0;
    std::size_t second = capacity;  // `rect` itself
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (std::size_t i = 0; i < count_; ++i) {
        for (std::size_t j = i + 1; j <= count_; ++j) {
            const std::int64_t pixels = gain(rects_[i], j == count_ ? rect : rects_[j]);
            if (pixels < least) {
                least = pixels;
                first = i;
                second = j;
            }
        }
    }
    if (second == count_) {
        const PixelRect merged = around(rects_[first], rect);
        remove(first);
        return merged;
    }
    // There is room now: the caller adds `rect` last, and the merged rectangle goes in by itself.
    const PixelRect merged = around(rects_[first], rects_[second]);
    remove(second);
    remove(first);
    add(merged);
    return rect;
}

void PixelRegion::add(const PixelRegion& region) {
    for (const PixelRect& rect : region.rects()) {
        add(rect);
    }
}

void PixelRegion::remove(std::size_t index) {
    rects_[index] = rects_[--count_];
}

PixelRect PixelRegion::bounds() const {
    PixelRect all;
    for (const PixelRect& rect : rects()) {
        all = around(all, rect);
    }
    return all;
}

std::int64_t PixelRegion::area() const {
    std::int64_t pixels = 0;
    for (const PixelRect& rect : rects()) {
        pixels += rect.area();
    }
    return pixels;
}

bool PixelRegion::covers(const PixelRect& rect) const {
    return rect.empty() ||
           std::ranges::any_of(rects(), [&](const PixelRect& held) { return contains(held, rect); });
}

PixelRegion PixelRegion::confined(int width, int height) const {
    PixelRegion part;
    for (const PixelRect& rect : rects()) {
        part.add(confine(rect, width, height));
    }
    return part;
}

}  // namespace viscera

#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace viscera {

/// Rectangle in pixels, origin at the bottom left.
struct PixelRect {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;

    [[nodiscard]] bool empty() const { return width <= 0 || height <= 0; }
    [[nodiscard]] std::int64_t area() const {
        return empty() ? 0 : static_cast<std::int64_t>(width) * height;
    }
    bool operator==(const PixelRect&) const = default;
};

/// The smallest rectangle around both.
[[nodiscard]] inline PixelRect around(const PixelRect& a, const PixelRect& b) {
    if (a.empty() || b.empty()) {
        return b.empty() ? a : b;
    }
    const int left = std::min(a.x, b.x);
    const int bottom = std::min(a.y, b.y);
    return {left, bottom, std::max(a.x + a.width, b.x + b.width) - left,
            std::max(a.y + a.height, b.y + b.height) - bottom};
}

/// Whether they have a pixel in common.
[[nodiscard]] inline bool overlap(const PixelRect& a, const PixelRect& b) {
    return !a.empty() && !b.empty() && a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height &&
           b.y < a.y + a.height;
}

/// Whether every pixel of `inner` lies in `outer`.
[[nodiscard]] inline bool contains(const PixelRect& outer, const PixelRect& inner) {
    return inner.empty() || around(outer, inner) == outer;
}

/// The part of a rectangle that lies on a target of this size [pixels].
[[nodiscard]] inline PixelRect confine(const PixelRect& rect, int width, int height) {
    const int left = std::clamp(rect.x, 0, width);
    const int bottom = std::clamp(rect.y, 0, height);
    return {left, bottom, std::clamp(rect.x + rect.width, left, width) - left,
            std::clamp(rect.y + rect.height, bottom, height) - bottom};
}

/// The part of a rectangle that lies outside another, in four rectangles that do not overlap; some may be
/// empty.
[[nodiscard]] inline std::array<PixelRect, 4> outside(const PixelRect& rect, const PixelRect& hole) {
    if (!overlap(rect, hole)) {
        return {rect};
    }
    const int top = rect.y + rect.height;
    const int right = rect.x + rect.width;
    const int low = std::max(rect.y, hole.y);
    const int high = std::min(top, hole.y + hole.height);
    const int left_end = std::max(rect.x, hole.x);
    const int right_begin = std::min(right, hole.x + hole.width);
    return {{{rect.x, rect.y, rect.width, low - rect.y},
             {rect.x, high, rect.width, top - high},
             {rect.x, low, left_end - rect.x, high - low},
             {right_begin, low, right - right_begin, high - low}}};
}

}  // namespace viscera

#pragma once

#include <cstddef>

namespace viscera {

/// Number of a pixel, texel or tile, counted row by row.
[[nodiscard]] constexpr std::size_t pixel_index(int x, int y, int width) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

}  // namespace viscera

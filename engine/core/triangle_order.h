#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace viscera {

/// Memory that triangle_order() works in; kept between frames, a warm call allocates nothing.
struct TriangleOrderScratch {
    std::vector<std::uint32_t> keys;
    std::vector<std::uint32_t> other_keys;
    std::vector<std::uint32_t> order;
    std::vector<std::uint32_t> other_order;
};

/// Key by which floats order as numbers do, negative ones too; NaN comes last.
[[nodiscard]] std::uint32_t float_order_key(float value);

/// Reorders triangles by rising scratch.keys, one per triangle; equal keys keep their order.
/// indices: 3 per triangle (a trailing incomplete triangle is dropped). sorted: receives the reordered ones.
/// Throws Error(usage) when the number of keys is another.
void triangle_order(std::span<const std::uint32_t> indices, TriangleOrderScratch& scratch,
                    std::vector<std::uint32_t>& sorted);

}  // namespace viscera

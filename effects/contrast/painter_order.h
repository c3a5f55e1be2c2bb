#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace viscera::contrast {

/// Which density of its three vertices stands for a triangle.
enum class PainterKey { max, mean };

/// Memory that painter_order() works in; kept between frames, a warm call allocates nothing.
struct PainterScratch {
    std::vector<std::uint32_t> keys;
    std::vector<std::uint32_t> other_keys;
    std::vector<std::uint32_t> order;
    std::vector<std::uint32_t> other_order;
};

/// Reorders triangles from dim to bright, so that drawing without a depth test leaves the brightest on top.
/// Triangles of equal density keep their order.
/// indices: 3 per triangle, each < vertex_density.size(); density: in [0, 1], anything else counts as 0.
/// sorted: receives the reordered indices (same size; a trailing incomplete triangle is dropped).
void painter_order(std::span<const std::uint32_t> indices, std::span<const float> vertex_density,
                   PainterKey key, PainterScratch& scratch, std::vector<std::uint32_t>& sorted);

}  // namespace viscera::contrast

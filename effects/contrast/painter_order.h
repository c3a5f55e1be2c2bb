#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/triangle_order.h"

namespace viscera::contrast {

/// Which density of its three vertices stands for a triangle.
enum class PainterKey { max, mean };

/// Reorders triangles from dim to bright, so that drawing without a depth test leaves the brightest on top.
/// Triangles of equal density keep their order.
/// indices: 3 per triangle, each < vertex_density.size(); density: in [0, 1], anything else counts as 0.
/// sorted: receives the reordered indices (same size; a trailing incomplete triangle is dropped).
void painter_order(std::span<const std::uint32_t> indices, std::span<const float> vertex_density,
                   PainterKey key, TriangleOrderScratch& scratch, std::vector<std::uint32_t>& sorted);

}  // namespace viscera::contrast

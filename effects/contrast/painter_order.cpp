#include "effects/contrast/painter_order.h"

#include <algorithm>
#include <cstddef>

namespace viscera::contrast {
namespace {

std::uint32_t sort_key(float a, float b, float c, PainterKey key) {
    const float value = key == PainterKey::max ? std::max({a, b, c}) : (a + b + c) / 3.0F;
    return float_order_key(value > 0.0F ? value : 0.0F);
}

}  // namespace

void painter_order(std::span<const std::uint32_t> indices, std::span<const float> vertex_density,
                   PainterKey key, TriangleOrderScratch& scratch, std::vector<std::uint32_t>& sorted) {
    const std::size_t triangles = indices.size() / 3;
    scratch.keys.resize(triangles);
    const auto density = [&](std::size_t corner) {
        const std::size_t vertex = indices[corner];
        const float value = vertex < vertex_density.size() ? vertex_density[vertex] : 0.0F;
        return value > 0.0F ? value : 0.0F;
    };
    for (std::size_t t = 0; t < triangles; ++t) {
        scratch.keys[t] = sort_key(density(3 * t), density(3 * t + 1), density(3 * t + 2), key);
    }
    triangle_order(indices, scratch, sorted);
}

}  // namespace viscera::contrast

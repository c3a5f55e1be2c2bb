#include "effects/contrast/painter_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

namespace viscera::contrast {
namespace {

constexpr unsigned digit_bits = 11;
constexpr std::size_t digit_count = std::size_t{1} << digit_bits;

// The bits of non-negative floats order as the floats do.
std::uint32_t sort_key(float a, float b, float c, PainterKey key) {
    const float value = key == PainterKey::max ? std::max({a, b, c}) : (a + b + c) / 3.0F;
    return value > 0.0F ? std::bit_cast<std::uint32_t>(value) : 0U;
}

// One stable counting pass; says false when all keys share the digit and nothing moved.
bool radix_pass(PainterScratch& s, unsigned shift) {
    std::array<std::uint32_t, digit_count> start{};
    for (const std::uint32_t key : s.keys) {
        ++start[(key >> shift) % digit_count];
    }
    if (std::ranges::find(start, static_cast<std::uint32_t>(s.keys.size())) != start.end()) {
        return false;
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& count : start) {
        sum += std::exchange(count, sum);
    }
    for (std::size_t i = 0; i < s.keys.size(); ++i) {
        const std::uint32_t to = start[(s.keys[i] >> shift) % digit_count]++;
        s.other_keys[to] = s.keys[i];
        s.other_order[to] = s.order[i];
    }
    return true;
}

}  // namespace

void painter_order(std::span<const std::uint32_t> indices, std::span<const float> vertex_density,
                   PainterKey key, PainterScratch& scratch, std::vector<std::uint32_t>& sorted) {
    const std::size_t triangles = indices.size() / 3;
    scratch.keys.resize(triangles);
    scratch.order.resize(triangles);
    scratch.other_keys.resize(triangles);
    scratch.other_order.resize(triangles);
    const auto density = [&](std::size_t corner) {
        const std::size_t vertex = indices[corner];
        const float value = vertex < vertex_density.size() ? vertex_density[vertex] : 0.0F;
        return value > 0.0F ? value : 0.0F;
    };
    for (std::size_t t = 0; t < triangles; ++t) {
        scratch.keys[t] = sort_key(density(3 * t), density(3 * t + 1), density(3 * t + 2), key);
        scratch.order[t] = static_cast<std::uint32_t>(t);
    }
    for (unsigned shift = 0; shift < 32 && triangles > 1; shift += digit_bits) {
        if (radix_pass(scratch, shift)) {
            scratch.keys.swap(scratch.other_keys);
            scratch.order.swap(scratch.other_order);
        }
    }
    sorted.resize(3 * triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        const std::size_t from = std::size_t{3} * scratch.order[t];
        std::copy_n(indices.begin() + static_cast<std::ptrdiff_t>(from), 3,
                    sorted.begin() + static_cast<std::ptrdiff_t>(3 * t));
    }
}

}  // namespace viscera::contrast

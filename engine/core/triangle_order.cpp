#include "engine/core/triangle_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "engine/core/error.h"

namespace viscera {
namespace {

constexpr unsigned digit_bits = 11;
constexpr std::size_t digit_count = std::size_t{1} << digit_bits;

// One stable counting pass; says false when all keys share the digit and nothing moved.
bool radix_pass(TriangleOrderScratch& s, unsigned shift) {
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

std::uint32_t float_order_key(float value) {
    if (std::isnan(value)) {
        return ~std::uint32_t{0};
    }
    const auto bits = std::bit_cast<std::uint32_t>(value + 0.0F);  // no -0
    constexpr std::uint32_t sign = 0x80000000U;
    return (bits & sign) != 0 ? ~bits : bits | sign;
}

void triangle_order(std::span<const std::uint32_t> indices, TriangleOrderScratch& scratch,
                    std::vector<std::uint32_t>& sorted) {
    const std::size_t triangles = indices.size() / 3;
    if (scratch.keys.size() != triangles) {
        throw Error(ErrorCode::usage, "triangle order", "needs one key per triangle");
    }
    scratch.order.resize(triangles);
    scratch.other_keys.resize(triangles);
    scratch.other_order.resize(triangles);
    std::iota(scratch.order.begin(), scratch.order.end(), 0U);
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

}  // namespace viscera

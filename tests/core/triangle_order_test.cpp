#include "engine/core/triangle_order.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

#include "engine/core/error.h"

namespace viscera::test {
namespace {

TEST(TriangleOrder, KeysOrderAsNumbersDo) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    constexpr std::array<float, 9> rising{-infinity, -1e30F, -2.0F,   -1e-40F, 0.0F,
                                          1e-40F,    1.5F,   3.4e38F, infinity};
    for (std::size_t i = 1; i < rising.size(); ++i) {
        EXPECT_LT(float_order_key(rising[i - 1]), float_order_key(rising[i])) << rising[i];
    }
    EXPECT_EQ(float_order_key(-0.0F), float_order_key(0.0F));
    EXPECT_GT(float_order_key(std::numeric_limits<float>::quiet_NaN()), float_order_key(infinity));
}

TEST(TriangleOrder, EqualKeysKeepTheirOrderAndIncompleteTrianglesGo) {
    const std::array<std::uint32_t, 13> indices{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    TriangleOrderScratch scratch;
    for (const float depth : {2.0F, -3.0F, 2.0F, -7.0F}) {
        scratch.keys.push_back(float_order_key(depth));
    }
    std::vector<std::uint32_t> sorted;
    triangle_order(indices, scratch, sorted);
    EXPECT_EQ(sorted, (std::vector<std::uint32_t>{9, 10, 11, 3, 4, 5, 0, 1, 2, 6, 7, 8}));
    scratch.keys.pop_back();
    EXPECT_THROW(triangle_order(indices, scratch, sorted), Error);
}

}  // namespace
}  // namespace viscera::test

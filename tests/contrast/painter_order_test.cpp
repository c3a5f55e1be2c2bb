#include "effects/contrast/painter_order.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace viscera::contrast {
namespace {

float key_of(std::span<const std::uint32_t> triangle, std::span<const float> density, PainterKey key) {
    const float a = density[triangle[0]];
    const float b = density[triangle[1]];
    const float c = density[triangle[2]];
    return key == PainterKey::max ? std::max({a, b, c}) : (a + b + c) / 3.0F;
}

TEST(PainterOrder, IsAStableSort) {
    std::mt19937 random(3);
    std::uniform_int_distribution<int> level(0, 40);
    std::vector<float> density(3000);
    std::ranges::generate(density, [&] { return static_cast<float>(level(random)) / 40.0F; });
    std::vector<std::uint32_t> indices(30000);
    std::ranges::generate(indices, [&] { return static_cast<std::uint32_t>(random() % density.size()); });
    for (const PainterKey key : {PainterKey::max, PainterKey::mean}) {
        std::vector<std::size_t> order(indices.size() / 3);
        std::iota(order.begin(), order.end(), 0U);
        std::ranges::stable_sort(order, {}, [&](std::size_t t) {
            return key_of(std::span(indices).subspan(3 * t, 3), density, key);
        });
        std::vector<std::uint32_t> expected;
        for (const std::size_t t : order) {
            expected.insert(expected.end(), {indices[3 * t], indices[3 * t + 1], indices[3 * t + 2]});
        }
        TriangleOrderScratch scratch;
        std::vector<std::uint32_t> sorted;
        painter_order(indices, density, key, scratch, sorted);
        EXPECT_EQ(sorted, expected);
    }
}

TEST(PainterOrder, TakesBadDensityAsZeroAndEmptyMeshes) {
    const std::vector<float> density{std::numeric_limits<float>::quiet_NaN(), -1.0F, 0.5F};
    const std::vector<std::uint32_t> indices{2, 2, 2, 0, 0, 0, 1, 1, 1};
    TriangleOrderScratch scratch;
    std::vector<std::uint32_t> sorted;
    painter_order(indices, density, PainterKey::max, scratch, sorted);
    EXPECT_EQ(sorted, (std::vector<std::uint32_t>{0, 0, 0, 1, 1, 1, 2, 2, 2}));
    painter_order({}, {}, PainterKey::max, scratch, sorted);
    EXPECT_TRUE(sorted.empty());
}

TEST(PainterOrder, WarmCallsKeepTheirMemory) {
    const std::vector<float> density{0.9F, 0.1F};
    const std::vector<std::uint32_t> indices{0, 0, 0, 1, 1, 1};
    TriangleOrderScratch scratch;
    std::vector<std::uint32_t> sorted;
    painter_order(indices, density, PainterKey::max, scratch, sorted);
    const auto memory = [&] {
        std::vector<const void*> all{scratch.keys.data(), scratch.other_keys.data(), scratch.order.data(),
                                     scratch.other_order.data()};
        std::ranges::sort(all);
        return all;
    };
    const auto before = memory();
    const auto* target = sorted.data();
    painter_order(indices, density, PainterKey::max, scratch, sorted);
    EXPECT_EQ(memory(), before);
    EXPECT_EQ(sorted.data(), target);
}

}  // namespace
}  // namespace viscera::contrast

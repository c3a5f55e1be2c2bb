#include "engine/core/pixel_region.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "engine/core/change_log.h"

namespace viscera {
namespace {

bool holds(const PixelRegion& region, int x, int y) {
    return region.covers({x, y, 1, 1});
}

TEST(PixelRegion, HoldsAllThatWasAddedAndNoPixelTwice) {
    std::mt19937 random(5);
    const auto pick = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    for (int trial = 0; trial < 400; ++trial) {
        PixelRegion region;
        std::vector<PixelRect> added;
        const int count = 1 + pick(40);
        for (int i = 0; i < count; ++i) {
            added.push_back({pick(60), pick(60), pick(9), pick(9)});
            region.add(added.back());
        }
        EXPECT_LE(region.rects().size(), PixelRegion::capacity);
        PixelRect bounds;
        for (const PixelRect& rect : added) {
            EXPECT_TRUE(region.covers(rect));
            bounds = around(bounds, rect);
        }
        EXPECT_EQ(region.bounds(), bounds);
        for (std::size_t i = 0; i < region.rects().size(); ++i) {
            EXPECT_FALSE(region.rects()[i].empty());
            for (std::size_t j = 0; j < i; ++j) {
                EXPECT_FALSE(overlap(region.rects()[i], region.rects()[j]));
            }
        }
    }
}

TEST(PixelRegion, FarPartsStayApart) {
    PixelRegion region;
    for (int i = 0; i < 16; ++i) {
        region.add({100 * (i % 4), 100 * (i / 4), 10, 10});
    }
    EXPECT_EQ(region.area(), 1600);
    region.add({11, 0, 10, 10});  // one too many: merged where it costs least
    EXPECT_EQ(region.rects().size(), 16U);
    EXPECT_EQ(region.area(), 1710);
    EXPECT_TRUE(holds(region, 20, 9));
    EXPECT_FALSE(holds(region, 50, 5));
}

TEST(PixelRegion, NothingIsNothing) {
    PixelRegion region;
    region.add(PixelRect{});
    region.add({4, 4, -3, 5});
    EXPECT_TRUE(region.empty());
    EXPECT_EQ(region.area(), 0);
    EXPECT_TRUE(region.bounds().empty());
    EXPECT_FALSE(region.covers({0, 0, 1, 1}));
}

TEST(PixelRegion, IsConfinedToTheTarget) {
    PixelRegion region(PixelRect{-5, 3, 10, 100});
    region.add({20, 0, 4, 4});
    const PixelRegion part = region.confined(8, 16);
    ASSERT_EQ(part.rects().size(), 1U);
    EXPECT_EQ(part.rects()[0], (PixelRect{0, 3, 5, 13}));
}

TEST(ChangeLog, FollowsUpdatesBack) {
    ChangeLog log;
    log.note(2, 1, PixelRect{0, 0, 4, 4});
    log.note(3, 2, PixelRect{10, 0, 4, 4});
    EXPECT_EQ(log.between(2, 2)->area(), 0);
    EXPECT_EQ(log.between(2, 3)->bounds(), (PixelRect{10, 0, 4, 4}));
    EXPECT_EQ(log.between(1, 3)->area(), 32);
    EXPECT_FALSE(log.between(3, 1)) << "only forwards";
    EXPECT_FALSE(log.between(9, 3));
    EXPECT_FALSE(log.between(1, 0)) << "0 names no picture";
    EXPECT_FALSE(log.between(0, 3)) << "0 names no picture";
}

TEST(ChangeLog, ForgetsTheOldest) {
    ChangeLog log;
    for (std::uint64_t key = 2; key < 200; ++key) {
        log.note(key, key - 1, PixelRect{0, 0, 1, 1});
    }
    EXPECT_TRUE(log.between(197, 199));
    EXPECT_FALSE(log.between(100, 120));
    EXPECT_FALSE(log.between(150, 199)) << "copying all is cheaper than so long a way";
}

TEST(PixelRect, OutsideHoldsEachPixelBesideTheHoleOnce) {
    const PixelRect rect{2, 3, 3, 2};
    for (int seed = 0; seed < 7 * 7 * 5 * 5; ++seed) {
        const PixelRect hole{seed % 7, seed / 7 % 7, seed / 49 % 5, seed / 245};
        const auto has = [](const PixelRect& r, int x, int y) { return overlap(r, {x, y, 1, 1}); };
        for (int y = 0; y < 9; ++y) {
            for (int x = 0; x < 9; ++x) {
                int held = 0;
                for (const PixelRect& part : outside(rect, hole)) {
                    held += has(part, x, y) ? 1 : 0;
                }
                ASSERT_EQ(held, has(rect, x, y) && !has(hole, x, y) ? 1 : 0)
                    << "at " << x << "," << y << " hole " << hole.x << "," << hole.y << " " << hole.width
                    << " x " << hole.height;
            }
        }
    }
}

}  // namespace
}  // namespace viscera

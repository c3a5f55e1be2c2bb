#include <algorithm>
#include <deque>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "effects/tissue/drop_ring.h"

// Which drops are drawn, held against which live.
namespace viscera::test {
namespace {

using tissue::DropRange;
using tissue::DropRing;

constexpr std::int64_t capacity = 160;  // ten groups

/// Places in the ring that may hold a living drop.
std::vector<int> listed_in(const DropRing& ring) {
    std::vector<int> listed;
    for (int place = 0; place < std::ssize(ring.lives()) * DropRing::group_size; ++place) {
        const auto group = static_cast<std::size_t>(place / DropRing::group_size);
        if ((ring.lives()[group] >> (place % DropRing::group_size) & 1) != 0) {
            listed.push_back(place);
        }
    }
    return listed;
}

/// An answer of the GPU.
std::vector<std::byte> lives_in(const std::vector<int>& places) {
    std::vector<std::byte> lives(static_cast<std::size_t>(capacity / 8), std::byte{0});
    for (const int place : places) {
        lives[static_cast<std::size_t>(place / 8)] |= std::byte{1} << (place % 8);
    }
    return lives;
}

std::vector<int> run_of(int first, int count) {
    std::vector<int> run(static_cast<std::size_t>(count));
    std::iota(run.begin(), run.end(), first);
    return run;
}

TEST(DropRing, ListsDropsUntilToldThatTheyHaveGone) {
    DropRing ring;
    EXPECT_EQ(listed_in(ring), std::vector<int>());
    EXPECT_EQ(ring.add(40, capacity).count, 0);
    EXPECT_EQ(listed_in(ring), run_of(0, 40));
    const std::uint64_t tag = ring.ask();
    const std::uint64_t version = ring.version();
    ring.hear(tag, lives_in({3, 15, 33}));
    EXPECT_EQ(listed_in(ring), (std::vector{3, 15, 33}));
    EXPECT_NE(ring.version(), version);
}

TEST(DropRing, AnAnswerSaysNothingOfDropsThatCameAfterTheQuestion) {
    DropRing ring;
    ring.add(20, capacity);
    const std::uint64_t tag = ring.ask();
    ring.add(2, capacity);  // into the second group
    ring.hear(tag, lives_in({}));
    EXPECT_EQ(listed_in(ring), run_of(16, 6));
    ring.hear(ring.ask(), lives_in({20}));
    EXPECT_EQ(listed_in(ring), std::vector{20});
}

TEST(DropRing, AnAnswerToAQuestionBeforeANewBeginningIsHeardInVain) {
    DropRing ring;
    ring.add(20, capacity);
    const std::uint64_t tag = ring.ask();
    ring.clear();
    EXPECT_EQ(ring.head(), 0);
    ring.add(20, capacity);
    ring.hear(tag, lives_in({}));
    EXPECT_EQ(listed_in(ring), run_of(0, 20));
}

TEST(DropRing, DropsInWhosePlacesOthersMayLiveTurnThemOut) {
    DropRing ring;
    EXPECT_EQ(ring.add(capacity, capacity).count, 0);
    const DropRange all = ring.add(20, capacity);
    EXPECT_EQ(all.first, capacity);
    EXPECT_EQ(all.count, 20);
    // Of the rest of the second group, still that of the first round, two live.
    ring.hear(ring.ask(), lives_in({19, 22, 30}));
    const DropRange rest = ring.add(20, capacity);
    EXPECT_EQ(rest.first, capacity + 22);
    EXPECT_EQ(rest.count, 9);
    EXPECT_EQ(ring.head(), capacity + 40);
}

/// A ring whose drops die at random, asked and answered late.
TEST(DropRing, ListsEachDropThatLivesAndForgetsTheOthers) {
    std::mt19937 random(7);
    const auto below = [&](int n) { return static_cast<std::int64_t>(random() % static_cast<unsigned>(n)); };
    DropRing ring;
    std::vector<bool> lives(capacity, false);
    struct Question {
        std::uint64_t tag = 0;
        std::vector<std::byte> answer;
    };
    std::deque<Question> asked;
    std::size_t turned_out = 0;
    for (int step = 0; step < 4000; ++step) {
        const std::int64_t count = step < 3900 ? below(step % 500 < 30 ? 90 : 5) : 0;
        const std::int64_t head = ring.head();
        const DropRange evicted = ring.add(count, capacity);
        ASSERT_TRUE(evicted.count == 0 ||
                    (evicted.first >= head && evicted.first + evicted.count <= head + count));
        for (std::int64_t place = head; place < head + count; ++place) {
            std::vector<bool>::reference here = lives[static_cast<std::size_t>(place % capacity)];
            if (here) {
                ASSERT_GE(place, evicted.first) << "at step " << step;
                ASSERT_LT(place, evicted.first + evicted.count) << "at step " << step;
                ++turned_out;
            }
            here = true;
        }
        for (std::size_t i = 0; i < lives.size(); ++i) {
            lives[i] = lives[i] && (step < 3900 ? below(20) > 0 : below(3) > 0);
        }
        if (below(3) == 0 || step >= 3990) {
            std::vector<int> places;
            for (int i = 0; i < capacity; ++i) {
                if (lives[static_cast<std::size_t>(i)]) {
                    places.push_back(i);
                }
            }
            asked.push_back({ring.ask(), lives_in(places)});
        }
        while (asked.size() > (step < 3990 ? 3U : 0U)) {
            ring.hear(asked.front().tag, asked.front().answer);
            asked.pop_front();
        }
        const std::vector<int> listed = listed_in(ring);
        for (int i = 0; i < capacity; ++i) {
            ASSERT_TRUE(!lives[static_cast<std::size_t>(i)] || std::ranges::binary_search(listed, i))
                << "place " << i << " at step " << step;
        }
    }
    EXPECT_GT(turned_out, 100U);
    EXPECT_TRUE(listed_in(ring).empty());
}

}  // namespace
}  // namespace viscera::test

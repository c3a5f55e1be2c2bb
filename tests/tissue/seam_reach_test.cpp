#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "effects/tissue/seam_reach.h"

// Which squares of texels blood may reach across seams, held against the rule asked texel by texel.
namespace viscera::test {
namespace {

using tissue::SeamJump;
using tissue::SeamLink;
using tissue::SeamReach;
using tissue::SquareGrid;

constexpr SquareGrid grid{.size = 52, .side = 8};  // the last squares are cut off
constexpr int past_seam = 4;

struct Seams {
    std::vector<SeamLink> links;
    std::vector<SeamJump> jumps;
};

Seams random_seams(unsigned seed) {
    std::mt19937 random(seed);
    const auto texel = [&] { return static_cast<int>(random() % (grid.size * grid.size)); };
    Seams seams;
    for (int i = 0; i < 12; ++i) {
        seams.links.push_back({static_cast<float>(texel()), static_cast<float>(texel()), 0.0F, 0.5F});
        seams.jumps.push_back({texel(), texel()});
    }
    return seams;
}

glm::ivec2 place_of(int texel) {
    return {texel % grid.size, texel / grid.size};
}

glm::ivec2 square_of(const glm::ivec2& texel) {
    return glm::clamp(texel, 0, grid.size - 1) / grid.side;
}

bool beside(const glm::ivec2& a, const glm::ivec2& b) {
    return glm::all(glm::lessThanEqual(glm::abs(a - b), glm::ivec2(1)));
}

/// What a square's items say; expects no more of them than its numbers need.
std::set<int> numbers_of(const SeamReach& reach, int square) {
    const auto at = static_cast<std::size_t>(square);
    const auto begin = static_cast<std::size_t>(reach.first.at(at).x);
    const auto count = static_cast<std::size_t>(reach.first.at(at).y);
    std::set<int> numbers;
    for (std::size_t i = begin; i < begin + count; ++i) {
        for (int k = 0; k < 4; ++k) {
            numbers.insert(static_cast<int>(reach.items.at(i)[k]));
        }
    }
    EXPECT_EQ(count, (numbers.size() + 3) / 4);
    return numbers;
}

TEST(SeamReach, BesideSeamsAreNeighboursOfWhatSeamsJoin) {
    for (const unsigned seed : {1U, 2U, 3U}) {
        const Seams seams = random_seams(seed);
        std::vector<std::pair<glm::ivec2, glm::ivec2>> joined;
        const auto join = [&](int a, int b) {
            joined.emplace_back(square_of(place_of(a)), square_of(place_of(b)));
            joined.emplace_back(square_of(place_of(b)), square_of(place_of(a)));
        };
        for (const SeamLink& link : seams.links) {
            join(static_cast<int>(link.from), static_cast<int>(link.to));
        }
        for (const SeamJump& jump : seams.jumps) {
            join(jump.gutter, jump.to);
        }
        const SeamReach reach = reach_beside_seams(grid, seams.links, seams.jumps);
        const int count = grid.count();
        ASSERT_EQ(count, 7);
        for (int square = 0; square < count * count; ++square) {
            std::set<int> expected;
            for (int other = 0; other < count * count; ++other) {
                const glm::ivec2 there(other % count, other / count);
                const bool reached = std::ranges::any_of(joined, [&](const auto& pair) {
                    return beside(pair.first, glm::ivec2(square % count, square / count)) &&
                           beside(pair.second, there);
                });
                if (reached) {
                    expected.insert(there.x + (there.y << 9));
                }
            }
            EXPECT_EQ(numbers_of(reach, square), expected) << "square " << square;
        }
    }
}

TEST(SeamReach, AcrossSeamsAreKindsOfHowBloodComes) {
    for (const unsigned seed : {4U, 5U, 6U}) {
        const Seams seams = random_seams(seed);
        const int count = grid.count();
        std::map<std::pair<int, int>, int> kinds;  // to, from
        const auto add = [&](const glm::ivec2& from, const glm::ivec2& to, int kind) {
            const glm::ivec2 here = square_of(from);
            const glm::ivec2 there = square_of(to);
            if (here != there) {
                kinds[{there.y * count + there.x, here.y * count + here.x}] |= kind;
            }
        };
        const auto flow = [&](int from, int to, bool towards) {
            add(place_of(from), place_of(to), tissue::reach_from_where_it_lies);
            for (const int y : {-past_seam, 0, past_seam}) {
                for (const int x : {-past_seam, 0, past_seam}) {
                    const glm::ivec2 way(x, y);
                    add(place_of(from), place_of(to) + way, tissue::reach_from_where_it_runs_far);
                    if (towards) {
                        add(place_of(from) + way, place_of(to), tissue::reach_from_where_it_runs_far);
                    }
                }
            }
        };
        for (const SeamLink& link : seams.links) {
            flow(static_cast<int>(link.from), static_cast<int>(link.to), true);
            flow(static_cast<int>(link.to), static_cast<int>(link.from), true);
        }
        for (const SeamJump& jump : seams.jumps) {
            flow(jump.gutter, jump.to, false);
            add(place_of(jump.to), place_of(jump.gutter), tissue::reach_of_gutters);
        }
        const SeamReach reach = reach_across_seams(grid, past_seam, seams.links, seams.jumps);
        for (int square = 0; square < count * count; ++square) {
            std::set<int> expected;
            for (const auto& [pair, kind] : kinds) {
                if (pair.first == square) {
                    const bool lies = (kind & tissue::reach_from_where_it_lies) != 0;
                    const int kept = lies ? kind & ~tissue::reach_from_where_it_runs_far : kind;
                    expected.insert(kept + ((pair.second % count) << 3) + ((pair.second / count) << 12));
                }
            }
            EXPECT_EQ(numbers_of(reach, square), expected) << "square " << square;
        }
    }
}

TEST(SeamReach, NothingIsReachedWithoutSeams) {
    for (const SeamReach& reach :
         {reach_beside_seams(grid, {}, {}), reach_across_seams(grid, past_seam, {}, {})}) {
        EXPECT_TRUE(reach.items.empty());
        ASSERT_EQ(reach.first.size(), 49U);
        EXPECT_EQ(reach.first[48], glm::vec2(0.0F));
    }
}

}  // namespace
}  // namespace viscera::test

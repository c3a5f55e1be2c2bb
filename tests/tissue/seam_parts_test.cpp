#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "effects/tissue/seam_links.h"

// Links across seams, put together by the cells that they change.
namespace viscera::test {
namespace {

using tissue::SeamLink;
using tissue::SeamPart;
using tissue::SeamParts;

constexpr std::size_t cells = 40;

TEST(SeamParts, EachLinkChangesBothItsCellsOnce) {
    std::mt19937 random(7);
    std::vector<SeamLink> links;
    for (int i = 0; i < 200; ++i) {
        // Few cells, so that many links join the same two, either way.
        const auto from = static_cast<float>(random() % 6);
        const auto to = 30.0F + static_cast<float>(random() % 6);
        const bool turned = random() % 2 == 0;
        links.push_back({turned ? to : from, turned ? from : to, static_cast<float>(random() % 4),
                         static_cast<float>(1 + random() % 100) / 256.0F});
    }
    const SeamParts seams = tissue::seam_parts(links, cells);
    ASSERT_EQ(seams.links.size(), 2 * links.size());
    ASSERT_EQ(seams.first.size(), cells);
    EXPECT_LT(seams.parts.size(), links.size());
    std::map<std::pair<float, float>, std::vector<SeamLink>> by_pair;  // cell, the one across
    for (std::size_t cell = 0; cell < cells; ++cell) {
        if (seams.first[cell] < 0.0F) {
            continue;
        }
        bool more = true;
        for (auto i = static_cast<std::size_t>(seams.first[cell]); more; ++i) {
            const SeamPart& part = seams.parts.at(i);
            std::vector<SeamLink>& found = by_pair[{static_cast<float>(cell), part.to}];
            EXPECT_TRUE(found.empty()) << "two parts join cells " << cell << " and " << part.to;
            for (int n = 0; n < static_cast<int>(part.count); ++n) {
                const SeamLink& link =
                    seams.links.at(static_cast<std::size_t>(part.first) + static_cast<std::size_t>(n));
                EXPECT_EQ(link.share > 0.0F ? link.from : link.to, static_cast<float>(cell));
                EXPECT_EQ(link.share > 0.0F ? link.to : link.from, part.to);
                found.push_back(link);
            }
            more = part.ends == 0.0F;
        }
    }
    std::size_t seen = 0;
    for (const auto& [pair, found] : by_pair) {
        // Both cells of a part meet its links in one order: sums are equal to the bit but for the sign.
        const std::vector<SeamLink>& back = by_pair[{pair.second, pair.first}];
        ASSERT_EQ(found.size(), back.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].from, back[i].from);
            EXPECT_EQ(found[i].side, back[i].side);
            EXPECT_EQ(found[i].share, -back[i].share);
        }
        seen += found.size();
    }
    EXPECT_EQ(seen, 2 * links.size());
}

TEST(SeamParts, WithoutLinksNoCellHasAny) {
    const SeamParts seams = tissue::seam_parts({}, cells);
    EXPECT_TRUE(seams.parts.empty());
    EXPECT_EQ(seams.first, std::vector<float>(cells, -1.0F));
}

}  // namespace
}  // namespace viscera::test

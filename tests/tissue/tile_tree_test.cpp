#include "effects/tissue/tile_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "effects/tissue/contact.h"
#include "engine/core/log.h"
#include "engine/io/mesh.h"
#include "engine/runtime/assets.h"
#include "engine/runtime/surface_mesh.h"
#include "tests/tissue/plane.h"

namespace viscera::test {
namespace {

using tissue::Contact;
using tissue::ContactAction;
using tissue::ContactList;
using tissue::TileTree;

double distance_to_way(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 way = b - a;
    const double length2 = glm::dot(way, way);
    const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, way) / length2, 0.0, 1.0) : 0.0;
    return glm::distance(p, a + t * way);
}

TEST(TileTree, EveryTexelInReachLiesInATileThatIsFound) {
    for (const bool seam : {false, true}) {
        Plane plane;
        plane.seam = seam;
        plane.cells = seam ? 16 : 2;  // large triangles, too
        Log log;
        Assets assets(log);
        tissue::TexelMap map;
        const auto mesh = SurfaceMesh::load(assets, {{.file = {plane.write("tiles")}}});
        constexpr int size = 100;  // the last tiles are cut off
        const auto texels = tissue::shared_texel_map(assets, *mesh, size, "tiles");
        // Bent, so that boxes are not flat.
        std::vector<glm::vec3> bent = mesh->data().positions;
        for (glm::vec3& p : bent) {
            p.z = 3.0F * std::sin(0.3F * p.x) + p.y * 0.2F;
        }
        TileTree tree(texels);
        tree.place(bent, mesh->data().indices);
        std::mt19937 random(3);
        std::uniform_real_distribution<double> place(-5.0, 45.0);
        std::uniform_real_distribution<double> length(0.0, 8.0);
        std::size_t found_tiles = 0;
        std::size_t missed = 0;
        for (int trial = 0; trial < 40; ++trial) {
            const glm::dvec3 a(place(random), place(random), length(random));
            const glm::dvec3 b =
                trial % 3 == 0 ? a : glm::dvec3(place(random), place(random), length(random));
            const double radius = length(random);
            std::vector<std::uint32_t> tiles;
            tree.near(a, b, radius, tiles);
            found_tiles += tiles.size();
            std::ranges::sort(tiles);
            EXPECT_TRUE(std::ranges::adjacent_find(tiles) == tiles.end());
            for (int y = 0; y < size; ++y) {
                for (int x = 0; x < size; ++x) {
                    const tissue::TexelPoint& point = texels->texels[static_cast<std::size_t>(y * size + x)];
                    if (point.owner == 0.0F) {
                        continue;
                    }
                    const auto t = static_cast<std::size_t>(point.triangle < 0.0F ? -point.triangle - 1.0F
                                                                                  : point.triangle);
                    const glm::dvec3 p0(bent[mesh->data().indices[3 * t]]);
                    const glm::dvec3 p1(bent[mesh->data().indices[3 * t + 1]]);
                    const glm::dvec3 p2(bent[mesh->data().indices[3 * t + 2]]);
                    const glm::dvec3 p = p0 + static_cast<double>(point.b1) * (p1 - p0) +
                                         static_cast<double>(point.b2) * (p2 - p0);
                    const auto tile = static_cast<std::uint32_t>(
                        y / TileTree::tile_texels * tree.tiles_per_side() + x / TileTree::tile_texels);
                    if (distance_to_way(p, a, b) <= radius && !std::ranges::binary_search(tiles, tile)) {
                        ++missed;
                    }
                }
            }
        }
        EXPECT_EQ(missed, 0U);
        EXPECT_LT(found_tiles, 40U * 49U * 7U / 10U) << "and not simply all of them";
    }
}

class ContactsTest : public testing::Test {
  protected:
    void give(std::vector<float> floats) { values_.set("tissue.contacts", floats); }
    std::span<const Contact> collect(double begin_s, double end_s) {
        list_.collect({}, &values_, {.begin_s = begin_s, .end_s = end_s});
        return list_.contacts();
    }
    HostValues values_;
    ContactList list_;
};

TEST_F(ContactsTest, GoOnFromWhereTheyWere) {
    give({1, 2, 3, 5, 2, 0});
    ASSERT_EQ(collect(0.0, 0.1).size(), 1U);
    EXPECT_EQ(list_.contacts()[0].from, glm::dvec3(1, 2, 3)) << "new: it begins where it is";
    EXPECT_DOUBLE_EQ(list_.contacts()[0].dose, 0.5);
    list_.keep_places(&values_);
    give({4, 2, 3, 5, 2, 0});
    EXPECT_EQ(collect(0.1, 0.2)[0].from, glm::dvec3(1, 2, 3));
    EXPECT_EQ(collect(0.1, 0.2)[0].from, glm::dvec3(1, 2, 3)) << "until the frame has been drawn";
    list_.keep_places(&values_);
    give({4, 5, 3, 5, 2, 2});
    EXPECT_EQ(collect(0.2, 0.3)[0].from, glm::dvec3(4, 5, 3)) << "another action is another contact";
    list_.keep_places(&values_);
    give({4, 500, 3, 5, 2, 2});
    EXPECT_EQ(collect(0.3, 0.4)[0].from, glm::dvec3(4, 500, 3)) << "lifted in between";
    values_.set("tissue.contacts_from", std::vector<float>{4, 5, 3});
    EXPECT_EQ(collect(0.3, 0.4)[0].from, glm::dvec3(4, 5, 3)) << "the host knows";
    values_.erase("tissue.contacts_from");
    give({4, 500, 3, 0, 2, 2});
    collect(0.4, 0.5);
    list_.keep_places(&values_);
    give({4, 501, 3, 5, 2, 2});
    EXPECT_EQ(collect(0.5, 0.6)[0].from, glm::dvec3(4, 501, 3)) << "it was off";
}

TEST_F(ContactsTest, WhatIsNoContactIsCounted) {
    const float nan = std::nanf("");
    const float inf = std::numeric_limits<float>::infinity();
    give({nan, 2, 3, 5, 2, 0, 1, 2, 3, inf, 2, 0, 1, 2, 3, 5,
          nan, 0, 1, 2, 3, 5, 2, 7, 1, 2,   3, 5, 2, 1, 9, 9});
    EXPECT_EQ(collect(0.0, 0.1).size(), 1U);
    EXPECT_EQ(list_.contacts()[0].action, ContactAction::ultrasound);
    EXPECT_EQ(list_.unusable(), 5U) << "four of them, and a piece at the end";
    give({1, 2, 3, -5, 2, 0});
    ASSERT_EQ(collect(0.0, 0.1).size(), 1U);
    EXPECT_EQ(list_.contacts()[0].action, ContactAction::dissect) << "as the published code has it";
}

TEST_F(ContactsTest, WhatHasNoWidthIsCounted) {
    give({1, 2, 3, 5, 0, 0, 1, 2, 3, 5, -1, 0, 1, 2, 3, 0, 0, 0});
    EXPECT_TRUE(collect(0.0, 0.1).empty());
    EXPECT_EQ(list_.unusable(), 2U) << "the third is off";
    list_.collect(std::vector<tissue::ContactParams>{{.sigma_mm = 0.0}}, nullptr,
                  {.begin_s = 0.0, .end_s = 0.1});
    EXPECT_EQ(list_.unusable(), 1U);
}

TEST_F(ContactsTest, PlacesBeforeThatAreNoneAreCounted) {
    const float nan = std::nanf("");
    give({1, 2, 3, 5, 2, 0, 4, 5, 6, 5, 2, 0});
    values_.set("tissue.contacts_from", std::vector<float>{nan, 2, 3, 4, 5, 5});
    ASSERT_FALSE(collect(0.0, 0.1).empty());
    EXPECT_EQ(list_.unusable_places(), 1U);
    const auto begins_at = [&](const glm::dvec3& place) {
        return std::ranges::any_of(list_.contacts(), [&](const Contact& c) { return c.from == place; });
    };
    EXPECT_TRUE(begins_at({1, 2, 3})) << "where it is";
    EXPECT_TRUE(begins_at({4, 5, 5}));
    for (const std::size_t count : {3U, 5U, 9U}) {
        values_.set("tissue.contacts_from", std::vector<float>(count, 7.0F));
        collect(0.0, 0.1);
        EXPECT_EQ(list_.unusable_places(), 1U) << count;
        EXPECT_TRUE(begins_at({1, 2, 3}) && begins_at({4, 5, 6})) << count << ": all are left out";
    }
    give({});
    collect(0.0, 0.1);
    EXPECT_EQ(list_.unusable_places(), 0U) << "no contact has come from anywhere";
}

TEST(ContactReach, IsWhereHalfAUnitInTheLastPlaceIsAdded) {
    for (const double rate : {1e-3, 0.1, 1.0, 50.0, 1e6}) {
        const double reach = tissue::contact_reach(rate, 2.0);
        ASSERT_GT(reach, 0.0);
        EXPECT_NEAR(rate / 60.0 * std::exp(-reach * reach / 8.0), 0x1p-24, 1e-12);
    }
    EXPECT_EQ(tissue::contact_reach(1e-6, 2.0), 0.0);
    EXPECT_EQ(tissue::contact_reach(0.0, 2.0), 0.0);
    EXPECT_EQ(tissue::contact_reach(1.0, 0.0), 0.0);
}

}  // namespace
}  // namespace viscera::test

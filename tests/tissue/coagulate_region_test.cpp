#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "effects/tissue/bipolar_effect.h"
#include "effects/tissue/coagulate_effect.h"
#include "engine/core/log.h"
#include "engine/core/params_json.h"
#include "engine/runtime/assets.h"
#include "tests/tissue/plane.h"

// The part of the texture that a frame of tissue.coagulate or tissue.coagulate_bipolar draws, against the
// texels that contacts and tools reach.
namespace viscera::test {
namespace {

using tissue::TileTree;

constexpr int size = 256;
constexpr double region_side_mm = 40.0;

/// Everything is there, in square targets.
class Preparation final : public Prepare {
  public:
    explicit Preparation(double time_s, const HostValues& values) {
        frame_.time_s = time_s;
        frame_.values = &values;
    }
    const Frame& frame() const override { return frame_; }
    Assets& assets() override { return assets_; }
    Log& log() override { return log_; }
    std::uint64_t parameters_key() const override { return 1; }
    bool has(std::string_view) const override { return true; }
    std::uint64_t subject(std::string_view) const override { return 0; }
    std::uint64_t content(std::string_view) const override { return 1; }
    glm::ivec2 size(std::string_view) const override { return glm::ivec2(test::size); }

  private:
    Frame frame_;
    Log log_;
    Assets assets_{log_};
};

void read(Effect& effect, const nlohmann::json& parameters) {
    std::vector<JsonFault> faults;
    read_params(
        parameters, "", {}, [&](ParamVisitor& v) { effect.visit(v); }, faults);
    ASSERT_TRUE(faults.empty()) << faults.front().message;
}

/// Whether a texel of that plane is meant, by its place [mm].
template <class Rule>
std::array<int, 4> tiles_of(Rule rule) {
    constexpr int t = TileTree::tile_texels;
    std::array<int, 4> box{size, size, 0, 0};
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const glm::dvec2 uv((x + 0.5) / size, (y + 0.5) / size);
            const glm::dvec2 place = (uv - 0.0625) / 0.875 * region_side_mm;
            if (rule(place)) {
                box = {std::min(box[0], x / t * t), std::min(box[1], y / t * t),
                       std::max(box[2], x / t * t + t), std::max(box[3], y / t * t + t)};
            }
        }
    }
    return box;
}

std::array<int, 4> corners_of(const Work& work) {
    const PixelRect box = work.region.bounds();
    return {box.x, box.y, box.x + box.width, box.y + box.height};
}

TEST(EnergyRegion, IsWhatAContactReaches) {
    // Tiles are found by boxes of parts of triangles: those here are little.
    constexpr int cells = 64;
    Plane plane;
    plane.cells = cells;
    const nlohmann::json mesh{{"file", plane.write("region_contacts").string()}};
    for (const glm::dvec2& at : {glm::dvec2(11.0, 25.0), glm::dvec2(30.5, 9.5)}) {
        tissue::CoagulateEffect effect;
        read(effect, {{"mesh", mesh}, {"size", size}});
        HostValues values;
        values.set("tissue.contacts", std::vector<float>{static_cast<float>(at.x), static_cast<float>(at.y),
                                                         0.0F, 1.0F, 0.5F, 0.0F});
        Preparation first(0.0, values);
        EXPECT_EQ(effect.prepare(first).kind, Work::Kind::idle);
        Preparation second(0.1, values);
        const Work work = effect.prepare(second);
        ASSERT_EQ(work.kind, Work::Kind::update);
        const double reach = tissue::contact_reach(1.0, 0.5);
        const auto within = [&](double mm) {
            return tiles_of([&](const glm::dvec2& p) { return glm::distance(p, at) <= mm; });
        };
        const std::array<int, 4> drawn = corners_of(work);
        const std::array<int, 4> least = within(reach);
        const std::array<int, 4> most = within(reach + region_side_mm / cells);
        for (const std::size_t low : {0U, 1U}) {
            EXPECT_LE(drawn[low], least[low]);
            EXPECT_GE(drawn[low], most[low]);
            EXPECT_GE(drawn[low + 2], least[low + 2]);
            EXPECT_LE(drawn[low + 2], most[low + 2]);
        }
        EXPECT_LT(work.region.area(), size * size / 16);
    }
}

TEST(EnergyRegion, OfContactsFarApartLeavesOutWhatLiesBetween) {
    const nlohmann::json mesh{{"file", Plane().write("region").string()}};
    tissue::CoagulateEffect effect;
    read(effect, {{"mesh", mesh}, {"size", size}});
    HostValues values;
    values.set("tissue.contacts", std::vector<float>{4, 4, 0, 1, 0.3F, 0, 36, 36, 0, 1, 0.3F, 0});
    Preparation first(0.0, values);
    (void)effect.prepare(first);
    Preparation second(0.1, values);
    const Work work = effect.prepare(second);
    ASSERT_EQ(work.kind, Work::Kind::update);
    EXPECT_GT(work.region.bounds().width, size / 2);
    EXPECT_LE(work.region.area(), 2 * 9 * TileTree::tile_texels * TileTree::tile_texels);
}

TEST(EnergyRegion, OfABipolarToolIsWhatItHoldsWithinIt) {
    Plane plane;
    plane.cells = 32;
    const nlohmann::json mesh{{"file", plane.write("region_fine").string()}};
    const auto region_of = [&](int reach, double radius_mm) {
        tissue::BipolarEffect effect;
        read(effect, {{"mesh", mesh},
                      {"size", size},
                      {"tool", {{"shape", "sphere"}, {"size_mm", {1.0, 1.0, radius_mm}}}}});
        std::vector<float> held;
        for (int y = 8 - reach; y <= 8 + reach; ++y) {
            for (int x = 8 - reach; x <= 8 + reach; ++x) {
                held.push_back(static_cast<float>(33 * y + x));
            }
        }
        HostValues values;
        values.set("tissue.held", held);
        values.set("tissue.tool", std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 10, 0, 1});
        Preparation prepare(0.0, values);
        const Work work = effect.prepare(prepare);
        EXPECT_EQ(work.kind, Work::Kind::update);
        return corners_of(work);
    };
    const glm::dvec2 at(10.0, 10.0);
    EXPECT_EQ(region_of(6, 2.0), tiles_of([&](const glm::dvec2& p) { return glm::distance(p, at) <= 2.0; }))
        << "the tool is smaller than what is held";
    EXPECT_EQ(region_of(0, 30.0), tiles_of([&](const glm::dvec2& p) {
                  const glm::dvec2 q = (p - at) / 1.25;
                  return std::max({std::abs(q.x), std::abs(q.y), std::abs(q.x - q.y)}) <= 1.0;
              }))
        << "the six triangles about a vertex";
}

/// 10,000 contacts that all reach all 4,096 tiles of 1024 x 1024 texels make 41 million entries.
TEST(PackedTile, KeepsEveryBitOfWhereItsContactsBegin) {
    for (const std::uint32_t begin : {0U, 4095U, 4096U, 16'777'217U, 40'950'001U, 2'147'000'001U}) {
        const glm::vec4 tile = tissue::packed_tile(511, 510, begin, begin + 60000);
        EXPECT_EQ((static_cast<int>(tile.y) << 12) + static_cast<int>(tile.z), static_cast<int>(begin));
        EXPECT_EQ(tile.w, 60000.0F);
        EXPECT_EQ(static_cast<int>(tile.x) & 1023, 511);
        EXPECT_EQ(static_cast<int>(tile.x) >> 10, 510);
    }
}

}  // namespace
}  // namespace viscera::test

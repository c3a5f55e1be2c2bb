#include "engine/core/volume.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "engine/core/error.h"

namespace viscera {
namespace {

template <class T>
Volume make_volume(const glm::ivec3& dims, ScalarType type, const std::vector<T>& values, int channels = 1) {
    Volume volume{.grid = {.dims = dims}, .type = type, .channels = channels, .source = "test"};
    volume.voxels.resize(values.size() * sizeof(T));
    std::memcpy(volume.voxels.data(), values.data(), volume.voxels.size());
    return volume;
}

ErrorCode code_of(const auto& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.where(), "test");
        return error.code();
    }
    return ErrorCode{};
}

TEST(Volume, TextureCoordinatesMeetVoxelCentres) {
    const VolumeGrid grid{.dims = {4, 5, 6},
                          .spacing_mm = {0.5, 1.0, 2.5},
                          .origin_mm = {-10.0, 20.0, 300.0},
                          .direction = glm::dmat3({0, 1, 0}, {-1, 0, 0}, {0, 0.6, 0.8})};
    const glm::dmat4 by_index = grid.index_to_world();
    const glm::dmat4 by_texture = grid.texture_to_world();
    EXPECT_EQ(glm::dvec3(by_index[3]), grid.origin_mm);
    for (const glm::dvec3 index : {glm::dvec3(0, 0, 0), glm::dvec3(3, 1, 5), glm::dvec3(2, 4, 0)}) {
        const glm::dvec3 texture = (index + 0.5) / glm::dvec3(grid.dims);
        const glm::dvec4 difference =
            by_index * glm::dvec4(index, 1.0) - by_texture * glm::dvec4(texture, 1.0);
        EXPECT_LT(glm::length(difference), 1e-12);
    }
    const glm::dvec3 along_k = glm::dvec3(by_texture[2]);
    EXPECT_NEAR(glm::length(along_k), 6 * 2.5, 1e-12);
}

TEST(Volume, FieldsThatDoNotHoldAreNamed) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Volume sound = make_volume<std::uint8_t>({2, 1, 1}, ScalarType::u8, {1, 2});
    EXPECT_NO_THROW(sound.validate());
    const auto expect = [&](std::string_view field, const auto& change) {
        Volume bad = sound;
        change(bad);
        try {
            bad.validate();
            ADD_FAILURE() << field << " is taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::file);
            EXPECT_NE(error.message().find(field), std::string_view::npos) << error.what();
        }
    };
    expect("dims", [](Volume& v) { v.grid.dims.y = 0; });
    expect("dims", [](Volume& v) { v.grid.dims = glm::ivec3(2'000'000'000); });
    expect("spacing", [](Volume& v) { v.grid.spacing_mm.z = 0.0; });
    expect("spacing", [](Volume& v) { v.grid.spacing_mm.x = -1.0; });
    expect("spacing", [&](Volume& v) { v.grid.spacing_mm.x = nan; });
    expect("origin", [&](Volume& v) { v.grid.origin_mm.y = nan; });
    expect("direction", [](Volume& v) { v.grid.direction[2] = v.grid.direction[0]; });
    expect("direction", [](Volume& v) { v.grid.direction[1] *= 2.0; });
    expect("channels", [](Volume& v) { v.channels = 5; });
    expect("slope", [](Volume& v) { v.slope = 0.0; });
    expect("intercept", [&](Volume& v) { v.intercept = nan; });
    expect("voxels", [](Volume& v) { v.voxels.pop_back(); });
}

TEST(Volume, StoredNumbersOfEveryType) {
    EXPECT_EQ(make_volume<std::uint8_t>({2, 1, 1}, ScalarType::u8, {1, 255}).stored({1, 0, 0}), 255.0);
    EXPECT_EQ(make_volume<std::int8_t>({2, 1, 1}, ScalarType::i8, {1, -128}).stored({1, 0, 0}), -128.0);
    EXPECT_EQ(make_volume<std::uint16_t>({1, 2, 1}, ScalarType::u16, {1, 65535}).stored({0, 1, 0}), 65535.0);
    EXPECT_EQ(make_volume<std::int16_t>({1, 1, 2}, ScalarType::i16, {1, -1024}).stored({0, 0, 1}), -1024.0);
    EXPECT_EQ(make_volume<float>({1, 1, 1}, ScalarType::f32, {1.5F, -2.5F}, 2).stored({0, 0, 0}, 1), -2.5);
}

TEST(VolumeStatistics, CountsFiniteValuesAfterRescale) {
    Volume volume = make_volume<std::int16_t>({5, 1, 1}, ScalarType::i16, {-24, 0, 0, 76, 176});
    volume.slope = -2.0;
    volume.intercept = 100.0;
    const VolumeStatistics integers = statistics(volume, 0, 4);
    EXPECT_EQ(integers.min, -252.0);
    EXPECT_EQ(integers.max, 148.0);
    EXPECT_DOUBLE_EQ(integers.mean, (148.0 + 100.0 + 100.0 - 52.0 - 252.0) / 5.0);
    EXPECT_EQ(integers.histogram, (std::vector<std::size_t>{1, 0, 1, 3}));

    const float inf = std::numeric_limits<float>::infinity();
    const VolumeStatistics floats =
        statistics(make_volume<float>({5, 1, 1}, ScalarType::f32, {NAN, 1.0F, inf, 3.0F, -inf}), 0, 2);
    EXPECT_EQ(floats.non_finite, 3U);
    EXPECT_EQ(floats.min, 1.0);
    EXPECT_EQ(floats.max, 3.0);
    EXPECT_EQ(floats.mean, 2.0);
    EXPECT_EQ(floats.histogram, (std::vector<std::size_t>{1, 1}));
}

TEST(VolumeStatistics, ConstantAndEmptyVolumesHaveARange) {
    const VolumeStatistics constant =
        statistics(make_volume<std::uint8_t>({3, 1, 1}, ScalarType::u8, {7, 7, 7}), 0, 4);
    EXPECT_EQ(constant.min, 7.0);
    EXPECT_EQ(constant.max, 7.0);
    EXPECT_EQ(constant.histogram[0], 3U);
    const VolumeStatistics none = statistics(make_volume<float>({2, 1, 1}, ScalarType::f32, {NAN, NAN}));
    EXPECT_EQ(none.min, 0.0);
    EXPECT_EQ(none.max, 0.0);
    EXPECT_EQ(none.mean, 0.0);
    EXPECT_EQ(none.non_finite, 2U);
    EXPECT_EQ(none.histogram, std::vector<std::size_t>(256, 0));
}

TEST(VolumeReduced, AveragesAndKeepsThePlace) {
    Volume volume = make_volume<std::int16_t>({3, 2, 1}, ScalarType::i16, {0, 2, 9, 4, 7, -10});
    volume.grid.spacing_mm = {1.0, 2.0, 3.0};
    volume.grid.direction = glm::dmat3({0, 0, 1}, {1, 0, 0}, {0, 1, 0});
    const Volume half = reduced(volume, 2);
    EXPECT_EQ(half.grid.dims, glm::ivec3(2, 1, 1));
    EXPECT_EQ(half.grid.spacing_mm, glm::dvec3(2.0, 4.0, 3.0));
    EXPECT_EQ(half.stored({0, 0, 0}), 3.0);   // 13 / 4 = 3.25
    EXPECT_EQ(half.stored({1, 0, 0}), -1.0);  // -1 / 2 away from zero
    const glm::dvec4 corner(0.0, 0.0, 0.0, 1.0);
    EXPECT_LT(glm::length(half.grid.texture_to_world() * corner - volume.grid.texture_to_world() * corner),
              1e-12);
    EXPECT_NO_THROW(half.validate());
}

TEST(VolumeReduced, LabelsTakeTheFirstAndNanCountsAsAbsent) {
    const Volume labels = make_volume<std::uint8_t>({4, 1, 1}, ScalarType::u8, {3, 9, 5, 1});
    const Volume half = reduced(labels, 2, true);
    EXPECT_EQ(half.stored({0, 0, 0}), 3.0);
    EXPECT_EQ(half.stored({1, 0, 0}), 5.0);
    const Volume floats = reduced(make_volume<float>({4, 1, 1}, ScalarType::f32, {NAN, 4.0F, NAN, NAN}), 2);
    EXPECT_EQ(floats.stored({0, 0, 0}), 4.0);
    EXPECT_TRUE(std::isnan(floats.stored({1, 0, 0})));
    const Volume channels =
        reduced(make_volume<std::uint8_t>({2, 1, 1}, ScalarType::u8, {10, 100, 20, 200}, 2), 2);
    EXPECT_EQ(channels.stored({0, 0, 0}, 0), 15.0);
    EXPECT_EQ(channels.stored({0, 0, 0}, 1), 150.0);
}

TEST(LiveVolume, TellsOnlyWhatChanged) {
    LiveVolume live(make_volume<std::uint8_t>({4, 3, 2}, ScalarType::u8, std::vector<std::uint8_t>(24, 0)));
    const std::uint64_t first = live.version();
    EXPECT_NE(first, 0U);
    bool everything = true;
    EXPECT_TRUE(live.changes_since(first, everything).empty());
    EXPECT_FALSE(everything);

    const std::vector<std::byte> ones(4, std::byte{1});
    const VoxelBox box{{1, 1, 1}, {2, 2, 1}};
    live.update(box, ones);
    const std::uint64_t second = live.version();
    EXPECT_GT(second, first);
    live.update({{0, 0, 0}, {4, 1, 1}}, ones);
    EXPECT_EQ(live.volume().stored({2, 2, 1}), 1.0);
    EXPECT_EQ(live.volume().stored({3, 2, 1}), 0.0);
    EXPECT_EQ(live.volume().stored({3, 0, 0}), 1.0);
    EXPECT_EQ(live.changes_since(first, everything).size(), 2U);
    EXPECT_FALSE(everything);
    EXPECT_EQ(live.changes_since(second, everything), (std::vector<VoxelBox>{{{0, 0, 0}, {4, 1, 1}}}));

    live.replace(live.volume());
    EXPECT_TRUE(live.changes_since(second, everything).empty());
    EXPECT_TRUE(everything);
    EXPECT_TRUE(live.changes_since(0, everything).empty());
    EXPECT_TRUE(everything);
}

TEST(LiveVolume, OldChangesAreForgottenAsAWhole) {
    LiveVolume live(make_volume<std::uint8_t>({1, 1, 1}, ScalarType::u8, {0}));
    const LiveVolume other(live.volume());
    EXPECT_NE(live.version(), other.version());
    const std::uint64_t first = live.version();
    const std::vector<std::byte> one(1, std::byte{1});
    bool everything = true;
    for (std::size_t count = 1; count <= 64; ++count) {
        live.update({{0, 0, 0}, {1, 1, 1}}, one);
        EXPECT_EQ(live.changes_since(first, everything).size(), count);
        EXPECT_FALSE(everything);
    }
    live.update({{0, 0, 0}, {1, 1, 1}}, one);
    EXPECT_TRUE(live.changes_since(first, everything).empty());
    EXPECT_TRUE(everything);
}

TEST(LiveVolume, WrongUpdatesChangeNothing) {
    LiveVolume live(make_volume<std::uint16_t>({2, 2, 2}, ScalarType::u16, std::vector<std::uint16_t>(8, 3)));
    const std::uint64_t version = live.version();
    const std::vector<std::byte> bytes(4, std::byte{9});
    const int most = std::numeric_limits<int>::max();
    for (const VoxelBox& box :
         {VoxelBox{{1, 0, 0}, {2, 1, 1}}, VoxelBox{{-1, 0, 0}, {2, 1, 1}}, VoxelBox{{0, 0, 0}, {1, 1, 1}},
          VoxelBox{{0, 0, most}, {1, 1, most}}, VoxelBox{{0, 0, 0}, {-2, -1, 1}}}) {
        EXPECT_EQ(code_of([&] { live.update(box, bytes); }), ErrorCode::usage);
    }
    EXPECT_EQ(live.version(), version);
    EXPECT_EQ(live.volume().stored({0, 0, 0}), 3.0);
    Volume bad = live.volume();
    bad.voxels.clear();
    EXPECT_EQ(code_of([&] { live.replace(bad); }), ErrorCode::file);
    EXPECT_EQ(live.version(), version);
}

}  // namespace
}  // namespace viscera

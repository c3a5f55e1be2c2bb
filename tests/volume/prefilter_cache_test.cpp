#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "effects/volume/prefilter.h"
#include "engine/core/error.h"
#include "tests/io/temp_folder.h"
#include "tests/volume/filter_kinds.h"

namespace viscera::test {
namespace {

/// Coefficients as one process after another would come by them.
class PrefilterCache : public testing::Test {
  protected:
    struct Load {
        std::vector<std::byte> coefficients;
        std::vector<double> told;  ///< of its progress: empty when nothing was solved
        std::map<std::string, std::uint64_t, std::less<>> faults;
    };
    static Load load(const volume::Source& source, const std::filesystem::path& cache, int channel = 0) {
        Load result;
        Log log;
        Assets assets(
            log,
            [&](std::string_view what, double fraction) {
                EXPECT_EQ(what, "prefiltering head.nrrd");
                result.told.push_back(fraction);
                return true;
            },
            cache);
        result.coefficients = volume::load_coefficients(assets, source, channel)->volume().voxels;
        result.faults = log.faults();
        return result;
    }
    [[nodiscard]] std::filesystem::path cache() const { return folder_ / "cache"; }
    [[nodiscard]] std::size_t entries() const {
        namespace fs = std::filesystem;
        return fs::exists(cache())
                   ? static_cast<std::size_t>(std::distance(fs::directory_iterator(cache()), {}))
                   : 0;
    }
    static Volume noise() {
        Volume volume = make_noise({31, 17, 23}, ScalarType::i16);
        volume.source = "/data/head.nrrd";
        return volume;
    }

    TempFolder folder_;
};

TEST_F(PrefilterCache, TheSecondLoadSolvesNothingAndHasTheSameBits) {
    const volume::Source source = make_source(noise());
    const Load without = load(source, {});
    const Load first = load(source, cache());
    const Load second = load(source, cache());
    EXPECT_FALSE(without.told.empty());
    EXPECT_FALSE(first.told.empty());
    EXPECT_TRUE(std::ranges::is_sorted(first.told));
    EXPECT_EQ(first.told.back(), 1.0);
    EXPECT_TRUE(second.told.empty());
    EXPECT_EQ(entries(), 1U);
    EXPECT_EQ(first.coefficients, without.coefficients);
    EXPECT_EQ(second.coefficients, without.coefficients);
    EXPECT_TRUE(second.faults.empty());
}

TEST_F(PrefilterCache, WhateverTheCoefficientsDependOnMakesThemAnew) {
    const auto expect_anew = [&](Volume volume, const char* what, int channel = 0) {
        const volume::Source source = make_source(std::move(volume));
        const std::size_t before = entries();
        EXPECT_FALSE(load(source, cache(), channel).told.empty()) << what;
        EXPECT_EQ(load(source, cache(), channel).coefficients, load(source, {}, channel).coefficients)
            << what;
        EXPECT_EQ(entries(), before + 1) << what;
    };
    expect_anew(noise(), "the first");
    Volume one_voxel = noise();
    one_voxel.voxels[1000] ^= std::byte{1};
    expect_anew(one_voxel, "a voxel");
    Volume other_dims = noise();
    other_dims.grid.dims = {17, 31, 23};
    expect_anew(other_dims, "dims");
    Volume other_type = noise();
    other_type.type = ScalarType::u16;
    expect_anew(other_type, "type");
    Volume two_channels = noise();
    two_channels.type = ScalarType::u8;
    two_channels.channels = 2;
    expect_anew(two_channels, "channels");
    expect_anew(two_channels, "channel", 1);
    Volume elsewhere = noise();
    elsewhere.grid.spacing_mm = {2.0, 2.0, 5.0};
    EXPECT_TRUE(load(make_source(elsewhere), cache()).told.empty()) << "where they lie does not matter";
}

TEST_F(PrefilterCache, NaNVoxelsTakeTheSmallestValue) {
    const auto with_nan = [](float least) {
        Volume volume = make_volume({9, 8, 7}, [&](const glm::ivec3& i) {
            return i == glm::ivec3(4, 4, 4)   ? std::numeric_limits<float>::quiet_NaN()
                   : i == glm::ivec3(0, 0, 0) ? least
                                              : 1.0F;
        });
        volume.source = "head.nrrd";
        return make_source(std::move(volume));
    };
    for (const float least : {0.0F, -1.0F}) {
        EXPECT_FALSE(load(with_nan(least), cache()).told.empty());
        EXPECT_EQ(load(with_nan(least), cache()).coefficients, load(with_nan(least), {}).coefficients);
    }
}

TEST_F(PrefilterCache, ADamagedEntryIsMadeAnew) {
    const volume::Source source = make_source(noise());
    const Load first = load(source, cache());
    for (const auto& entry : std::filesystem::directory_iterator(cache())) {
        std::string content = slurp(entry.path());
        content[content.size() / 2] ^= 1;
        std::ofstream(entry.path(), std::ios::binary) << content;
    }
    const Load again = load(source, cache());
    EXPECT_FALSE(again.told.empty());
    EXPECT_EQ(again.coefficients, first.coefficients);
    EXPECT_EQ(again.faults.at("cache.damaged"), 1U);
    EXPECT_TRUE(load(source, cache()).told.empty());
}

TEST_F(PrefilterCache, WhatAHostMayChangeIsNotKept) {
    LiveVolume live(noise());
    volume::Source source;
    source.live = &live;
    source.statistics = statistics(live.volume());
    EXPECT_FALSE(load(source, cache()).told.empty());
    EXPECT_EQ(entries(), 0U);
}

TEST_F(PrefilterCache, CancelledWorkLeavesNothingBehind) {
    const volume::Source source = make_source(noise());
    for (const double until : {0.0, 0.3, 0.7}) {
        Log log;
        bool stops = true;
        int after = 0;
        Assets assets(
            log,
            [&](std::string_view, double fraction) {
                after += stops && fraction > until ? 1 : 0;
                return !stops || fraction <= until;
            },
            cache());
        try {
            static_cast<void>(volume::load_coefficients(assets, source, 0));
            ADD_FAILURE() << "went on";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::usage);
            EXPECT_EQ(error.message(), "cancelled");
        }
        EXPECT_EQ(after, 1) << "asked again after it was told to stop";
        EXPECT_EQ(entries(), 0U);
        stops = false;
        EXPECT_EQ(volume::load_coefficients(assets, source, 0)->volume().voxels,
                  load(source, {}).coefficients);
        std::filesystem::remove_all(cache());
    }
}

}  // namespace
}  // namespace viscera::test

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "effects/volume/prefilter.h"
#include "engine/core/error.h"
#include "tests/volume/filter_kinds.h"

namespace viscera::test {
namespace {

using testing::HasSubstr;
using volume::AtlasLayout;
using volume::GpuVolume;
using volume::Storage;

class StorageTest : public testing::Test {
  protected:
    VolumeSampler sampler_;
};

TEST(AtlasLayout, EverySliceHasAPlaceOfItsOwnWithinTheLimits) {
    for (const glm::ivec3 dims : {glm::ivec3(1), glm::ivec3(3, 2, 4100), glm::ivec3(4100, 3, 2),
                                  glm::ivec3(600, 500, 20), glm::ivec3(512, 512, 512)}) {
        const auto layout = volume::lay_out(dims, 8192, 256);
        ASSERT_TRUE(layout);
        EXPECT_LE(std::max(layout->page().x, layout->page().y), 8192);
        EXPECT_LE(layout->layers, 256);
        EXPECT_EQ(layout->place_of(dims.z - 1).z, layout->layers - 1);  // none is empty
        for (int z = 0; z < dims.z; ++z) {
            const glm::ivec3 place = layout->place_of(z);
            ASSERT_LE(place.x + dims.x + 1, layout->page().x);
            ASSERT_LE(place.y + dims.y + 1, layout->page().y);
            const glm::ivec3 before = layout->place_of(std::max(z - 1, 0));
            const bool beside = z > 0 && place.y == before.y && place.z == before.z;
            if (beside) {
                ASSERT_EQ(place.x, before.x + dims.x + 2);
            }
        }
    }
}

TEST(AtlasLayout, LayersGrowBeyondTheFineSizeOnlyWhereTheyMust) {
    EXPECT_LE(volume::lay_out({100, 100, 2000}, 16384, 2048)->page().x, 256);
    EXPECT_GT(volume::lay_out({100, 100, 2000}, 16384, 3)->page().x, 1024);
    EXPECT_FALSE(volume::lay_out({100, 100, 2000}, 2048, 4));
    EXPECT_FALSE(volume::lay_out({2047, 1, 1}, 2048, 4));
    EXPECT_TRUE(volume::lay_out({2046, 1, 1}, 2048, 4));
}

TEST(ChooseStorage, SaysWhatIsNeededWhatThereIsAndWhatWouldFit) {
    const volume::TextureLimits limits{.side_3d = 256, .side_2d = 1024, .layers = 16};
    EXPECT_FALSE(volume::choose_storage({256, 256, 256}, Storage::automatic, limits, "v"));
    EXPECT_TRUE(volume::choose_storage({257, 3, 3}, Storage::automatic, limits, "v"));
    EXPECT_TRUE(volume::choose_storage({3, 3, 3}, Storage::atlas, limits, "v"));
    const auto message = [&](const glm::ivec3& dims, Storage storage) -> std::string {
        try {
            (void)volume::choose_storage(dims, storage, limits, "head.mha");
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::limit);
            return error.what();
        }
        return "";
    };
    EXPECT_THAT(message({257, 3, 3}, Storage::texture_3d),
                AllOf(HasSubstr("head.mha"), HasSubstr("257 x 3 x 3"), HasSubstr("256"),
                      HasSubstr("reduce = 2"), Not(HasSubstr("1024"))));
    EXPECT_THAT(message({5000, 3, 3}, Storage::automatic),
                AllOf(HasSubstr("5000 x 3 x 3"), HasSubstr("256"), HasSubstr("1024"), HasSubstr("16"),
                      HasSubstr("reduce = 5")));
}

TEST_F(StorageTest, AtlasAndTextureGiveTheSame) {
    const std::vector<glm::vec3> places = places_in(0.6, 4096);
    for (const ScalarType type : {ScalarType::u8, ScalarType::f32}) {
        const volume::Source source = make_source(make_noise({12, 9, 7}, type));
        const double range = source.statistics.max - source.statistics.min;
        const AtlasLayout layout = volume::lay_out({12, 9, 7}, 2048, 16).value();
        // The texture unit finds a place on a layer as finely as single precision counts its texels.
        const double rounding = std::max(layout.page().x, layout.page().y) * 0x1p-23;
        for (const FilterKind& kind : all_filter_kinds()) {
            const double held = kind.reconstruction.uses_coefficients() ? 5.0 * range : range;
            const auto a = sampler_.sample(source, kind.reconstruction, Storage::texture_3d, places);
            const auto b = sampler_.sample(source, kind.reconstruction, Storage::atlas, places);
            double difference = 0.0;
            for (std::size_t i = 0; i < places.size(); ++i) {
                difference = std::max(difference, std::abs(a[i].value - b[i].value));
            }
            EXPECT_LE(difference, kind.full_precision ? 0.0 : rounding * held) << kind.name;
        }
    }
}

TEST_F(StorageTest, AnAtlasOfSeveralLayersIsTheReference) {
    const volume::Source source = make_source(make_noise({600, 500, 20}, ScalarType::u8));
    const GpuVolume gpu(sampler_.gl(), source, 0, Storage::atlas);
    ASSERT_GT(gpu.texture().extent().depth, 1);
    const reference::Field field(source.volume(), reference::Filter::trilinear);
    const std::vector<glm::vec3> places = places_in(0.5, 4096);
    const auto samples = sampler_.sample(source, {.filter = volume::ReconstructionFilter::linear_fp32},
                                         Storage::atlas, places);
    const double range = source.statistics.max - source.statistics.min;
    for (std::size_t i = 0; i < places.size(); ++i) {
        ASSERT_NEAR(samples[i].value, field.value(glm::dvec3(places[i])), 2e-6 * range);
    }
}

TEST_F(StorageTest, LongVolumesGoBeyondTheLimitOf3dTextures) {
    const int limit = volume::TextureLimits::query(sampler_.gl()).side_3d;
    for (const glm::ivec3 dims : {glm::ivec3(4100, 3, 2), glm::ivec3(3, 2, 4100)}) {
        if (4100 <= limit) {
            GTEST_SKIP() << "this device holds it as a 3-D texture";
        }
        const volume::Source source = make_source(make_noise(dims, ScalarType::u16));
        const double range = source.statistics.max - source.statistics.min;
        const std::vector<glm::vec3> places = places_in(0.51, 4096);
        for (const FilterKind& kind : all_filter_kinds()) {
            if (!kind.full_precision || kind.reference == reference::Filter::nearest) {
                continue;
            }
            const reference::Field field(source.volume(), kind.reference);
            const auto samples = sampler_.sample(source, kind.reconstruction, Storage::automatic, places);
            for (std::size_t i = 0; i < places.size(); ++i) {
                ASSERT_NEAR(samples[i].value, field.value(glm::dvec3(places[i])), 2e-6 * range) << kind.name;
            }
        }
    }
}

TEST_F(StorageTest, WhatIsTooLargeForBothIsRefused) {
    const volume::TextureLimits limits = volume::TextureLimits::query(sampler_.gl());
    const volume::Source source = make_source(make_noise({limits.side_2d + 1, 1, 1}, ScalarType::u8));
    EXPECT_THROW(GpuVolume(sampler_.gl(), source, 0, Storage::automatic), Error);
}

/// A host's volume as a source.
volume::Source live_source(const LiveVolume& live) {
    volume::Source source;
    source.live = &live;
    source.statistics = statistics(live.volume());
    source.key = 1;
    return source;
}

TEST_F(StorageTest, ChangesReachTheirPlaceOnly) {
    const std::vector<glm::vec3> places = places_in(0.6, 4096);
    for (const Storage storage : {Storage::texture_3d, Storage::atlas}) {
        for (const VoxelBox box : {VoxelBox{{0, 0, 0}, {3, 2, 4}}, VoxelBox{{5, 4, 2}, {2, 3, 3}},
                                   VoxelBox{{10, 7, 5}, {2, 2, 2}}, VoxelBox{{0, 0, 0}, {12, 9, 7}}}) {
            LiveVolume live(make_noise({12, 9, 7}, ScalarType::u8));
            const volume::Source source = live_source(live);
            GpuVolume gpu(sampler_.gl(), source, 0, storage);
            std::vector<std::byte> data(static_cast<std::size_t>(box.size.x * box.size.y * box.size.z));
            for (std::size_t i = 0; i < data.size(); ++i) {
                data[i] = static_cast<std::byte>(37 * i);
            }
            live.update(box, data);
            gpu.update(source);
            const volume::ReconstructionParams linear;
            const auto changed = sampler_.sample(gpu, source, linear, places);
            const auto fresh = sampler_.sample(source, linear, storage, places);
            for (std::size_t i = 0; i < places.size(); ++i) {
                ASSERT_EQ(changed[i].value, fresh[i].value);
            }
        }
    }
}

TEST_F(StorageTest, AnotherVolumeInPlaceOfALiveOneMayHaveAnotherSize) {
    LiveVolume live(make_noise({5, 4, 3}, ScalarType::u8));
    const volume::Source source = live_source(live);
    GpuVolume gpu(sampler_.gl(), source, 0, Storage::texture_3d);
    live.replace(make_noise({7, 3, 6}, ScalarType::f32));
    gpu.update(source);
    EXPECT_EQ(gpu.texture().extent(), (gl::Extent{7, 3, 6}));
}

TEST(Coefficients, AreThoseOfTheReference) {
    for (const glm::ivec3 dims : {glm::ivec3(1), glm::ivec3(2, 1, 3), glm::ivec3(13, 8, 21)}) {
        const Volume volume = make_noise(dims, ScalarType::f32);
        const auto due =
            reference::bspline_coefficients(dims, reference::decoded(volume), reference::Edge::clamp);
        for (const int threads : {1, 2, 5}) {
            std::vector<float> voxels(volume.grid.voxel_count());
            std::memcpy(voxels.data(), volume.voxels.data(), volume.voxels.size());
            ASSERT_TRUE(volume::make_coefficients(dims, voxels, threads));
            for (std::size_t i = 0; i < voxels.size(); ++i) {
                ASSERT_NEAR(voxels[i], due[i], 4e-6);  // they reach some 10 times the voxels' range
            }
        }
    }
}

TEST_F(StorageTest, CoefficientsFollowALiveVolume) {
    LiveVolume live(make_noise({60, 20, 40}, ScalarType::f32));
    const auto first = volume::load_coefficients(sampler_.assets(), live_source(live), 0);
    const std::uint64_t version = first->version();
    const std::vector<float> data(27, 5.0F);
    live.update({{2, 3, 4}, {3, 3, 3}}, std::as_bytes(std::span(data)));
    const auto after = volume::load_coefficients(sampler_.assets(), live_source(live), 0);
    EXPECT_EQ(first, after);
    bool everything = false;
    const auto changes = after->live->changes_since(version, everything);
    ASSERT_EQ(changes.size(), 1U);
    EXPECT_EQ(changes[0], (VoxelBox{{0, 0, 0}, {21, 20, 23}}));  // only what it reaches
    EXPECT_FALSE(everything);
    const auto due = reference::bspline_coefficients(
        live.volume().grid.dims, reference::decoded(live.volume()), reference::Edge::clamp);
    glm::ivec3 i;
    std::size_t at = 0;
    for (i.z = 0; i.z < 40; ++i.z) {
        for (i.y = 0; i.y < 20; ++i.y) {
            for (i.x = 0; i.x < 60; ++i.x) {
                ASSERT_NEAR(after->volume().stored(i), due[at++], 1e-5);
            }
        }
    }
}

}  // namespace
}  // namespace viscera::test

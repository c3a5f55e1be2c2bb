// Accumulation of volumes that hold colours, beside its double-precision reference.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/reference/volume_lattice.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

constexpr int side = 24;

/// Smooth blobs of colour in black, 8 bits a channel; the least and greatest value are 0 and 255.
Volume blobs(int channels) {
    Volume volume{.grid = {.dims = glm::ivec3(side),
                           .spacing_mm = glm::dvec3(2.0),
                           .origin_mm = glm::dvec3(-1.0 * (side - 1))},
                  .type = ScalarType::u8,
                  .channels = channels,
                  .source = "blobs"};
    std::mt19937 random(5);
    const auto unit = [&] { return static_cast<double>(random() >> 8U) / 16777216.0; };
    std::vector<glm::dvec3> centres;
    for (int c = 0; c < channels; ++c) {
        centres.push_back(double{side} * (0.3 + 0.4 * glm::dvec3(unit(), unit(), unit())));
    }
    for (int z = 0; z < side; ++z) {
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                for (const glm::dvec3& centre : centres) {
                    const double r = glm::length(glm::dvec3(x, y, z) - centre) / 8.0;
                    const double value = r < 1.0 ? 255.0 * (1.0 - r) * (0.8 + 0.2 * unit()) : 0.0;
                    volume.voxels.push_back(static_cast<std::byte>(std::lround(value)));
                }
            }
        }
    }
    volume.voxels[0] = std::byte{255};
    return volume;
}

class ColourAccumulation : public testing::Test {
  protected:
    /// Slabs as long as the length that opacities are for.
    static nlohmann::json parameters(const nlohmann::json& channels) {
        const double slab_mm = 0.5;
        const double diagonal_mm = std::sqrt(3.0) * 2.0 * side;
        return {{"function", "accumulate"},
                {"accumulate",
                 {{"opacity", 1.5},
                  {"samples", diagonal_mm / slab_mm},
                  {"brightness", 0.1},
                  {"contrast", 0.8},
                  {"channels", channels}}},
                {"sampling",
                 {{"scheme", "midpoint"}, {"step", 0.25}, {"termination", 0.0}, {"filter", "linear_fp32"}}}};
    }
    static nlohmann::json channels(int count) {
        nlohmann::json list = nlohmann::json::array();
        for (int c = 0; c < count; ++c) {
            list.push_back(nlohmann::json::object());
        }
        return list;
    }
    /// Pixels that differ from the reference by more than `limit`.
    static int off(const Shot& shot, const Volume& volume, const nlohmann::json& p, double limit) {
        std::vector<reference::Field> fields;
        reference::Accumulate rule{.opacity = p["accumulate"]["opacity"],
                                   .samples = p["accumulate"]["samples"],
                                   .brightness = 0.1,
                                   .contrast = 0.8};
        for (int c = 0; c < volume.channels; ++c) {
            std::vector<double> shares = reference::decoded(volume, c);
            for (double& share : shares) {
                share /= 255.0;
            }
            fields.emplace_back(volume.grid.dims, std::move(shares), reference::Filter::trilinear,
                                reference::texture_to_world_of(volume.grid));
            const nlohmann::json& channel = p["accumulate"]["channels"][static_cast<std::size_t>(c)];
            if (channel.contains("threshold")) {
                rule.low[c] = channel["threshold"][0];
                rule.high[c] = channel["threshold"][1];
            }
        }
        int count = 0;
        int lit = 0;
        for (int y = 0; y < shot.image.height; ++y) {
            for (int x = 0; x < shot.image.width; ++x) {
                const reference::Ray ray = shot.ray(x, y);
                const auto interval = reference::intersect(ray, fields[0].texture_to_world());
                const glm::dvec4 wanted =
                    interval ? reference::accumulate(fields, ray, *interval, 0.5, rule) : glm::dvec4(0.0);
                const glm::dvec4 miss = glm::abs(shot.at(x, y) - wanted);
                count += !(std::max({miss.r, miss.g, miss.b, miss.a}) <= limit) ? 1 : 0;
                lit += wanted.a > 0.05 ? 1 : 0;
            }
        }
        EXPECT_GT(lit, 100);
        return count;
    }

    VolumeStage stage_;
    Look look_{.eye_mm = {110, -150, 60}, .fov_deg = 22};
};

TEST_F(ColourAccumulation, IsThatOfDoublePrecision) {
    for (const int count : {2, 3, 4}) {
        const LiveVolume volume(blobs(count));
        const nlohmann::json p = parameters(channels(count));
        // The last slab's opacity is a power here and a share in the reference: a^2 / 8 apart, 1e-5.
        EXPECT_EQ(off(stage_.cast(volume, p, look_), volume.volume(), p, 2e-5), 0) << count << " channels";
    }
}

TEST_F(ColourAccumulation, DropsWhatLeavesTheThresholdOfAnyChannel) {
    for (const int count : {2, 3, 4}) {
        const LiveVolume volume(blobs(count));
        nlohmann::json list = channels(count);
        list[0]["threshold"] = {0.0, 0.4};
        list[static_cast<std::size_t>(count - 1)]["threshold"] = {0.15, 1.0};
        const nlohmann::json p = parameters(list);
        // A sample within a rounding of a threshold may fall on either side of it.
        EXPECT_LE(off(stage_.cast(volume, p, look_), volume.volume(), p, 2e-5), 3) << count << " channels";
    }
}

TEST_F(ColourAccumulation, OfGreyIsThatOfItsOneChannel) {
    const Volume grey = blobs(1);
    Volume rgb = grey;
    rgb.channels = 3;
    rgb.voxels.clear();
    for (const std::byte value : grey.voxels) {
        rgb.voxels.insert(rgb.voxels.end(), 3, value);
    }
    nlohmann::json one = parameters(nlohmann::json::array());
    one["transfer_function"] = {{"interpolate", true}};
    const Shot wanted = stage_.cast(LiveVolume(grey), one, look_);
    const Shot shown = stage_.cast(LiveVolume(rgb), parameters(channels(3)), look_);
    EXPECT_LE(difference(wanted.image, shown.image).max, 1e-5);
}

TEST_F(ColourAccumulation, SkippingStorageAndSchemeChangeLittleOrNothing) {
    const LiveVolume volume(blobs(4));
    nlohmann::json list = channels(4);
    list[1]["threshold"] = {0.1, 0.9};
    for (const char* filter : {"nearest", "linear", "linear_fp32"}) {
        for (const char* scheme : {"midpoint", "gauss", "cell"}) {
            nlohmann::json p = parameters(list);
            p["sampling"]["filter"] = filter;
            p["sampling"]["scheme"] = scheme;
            const Shot skipped = stage_.cast(volume, p, look_);
            p["sampling"]["skip"] = false;
            EXPECT_TRUE(same_bits(skipped, stage_.cast(volume, p, look_))) << filter << ' ' << scheme;
            p["volume"]["storage"] = "atlas";
            const double off = difference(skipped.image, stage_.cast(volume, p, look_).image).max;
            EXPECT_LE(off, std::string_view(filter) == "linear" ? 1e-2 : 0.0) << filter << ' ' << scheme;
        }
    }
}

TEST_F(ColourAccumulation, FollowsALiveVolume) {
    LiveVolume volume(blobs(3));
    const nlohmann::json p = parameters(channels(3));
    const Shot before = stage_.cast(volume, p, look_);
    const std::vector<std::byte> voxels(4 * 4 * 4 * 3, std::byte{200});
    volume.update({glm::ivec3(10), glm::ivec3(4)}, voxels);
    const Shot after = stage_.cast_again(volume, before.view, glm::ivec2(64));
    EXPECT_FALSE(same_bits(before, after));
    VolumeStage fresh;
    EXPECT_TRUE(same_bits(after, fresh.cast(LiveVolume(volume.volume()), p, look_)));
}

TEST_F(ColourAccumulation, RefusesWhatTakesAValue) {
    const LiveVolume volume(blobs(3));
    EXPECT_THROW((void)stage_.cast(volume, parameters(channels(4)), look_), Error);
    EXPECT_THROW((void)stage_.cast(volume, parameters(channels(1)), look_), Error);
    for (const auto& [where, value] :
         std::map<std::string, nlohmann::json>{{"/sampling/scheme", "preintegrated"},
                                               {"/sampling/filter", "bspline"},
                                               {"/shading/enabled", true}}) {
        nlohmann::json p = parameters(channels(3));
        p[nlohmann::json::json_pointer(where)] = value;
        EXPECT_THROW((void)stage_.cast(volume, p, look_), Error) << where;
    }
}

}  // namespace
}  // namespace viscera::test

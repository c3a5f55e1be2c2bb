// Gradients that are kept for all voxels are the central differences of the trilinear filter.

#include <cmath>

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/sector_stage.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

class KeptGradients : public testing::Test {
  protected:
    static nlohmann::json parameters(std::string_view function, std::string_view gradient) {
        nlohmann::json p{{"function", function},
                         {"transfer_function",
                          {{"points",
                            {{{"value", -600}, {"opacity", 0.0}, {"colour", {0.8, 0.5, 0.4}}},
                             {{"value", 100}, {"opacity", 0.02}, {"colour", {0.9, 0.6, 0.5}}},
                             {{"value", 900}, {"opacity", 0.4}, {"colour", {1.0, 0.95, 0.9}}}}}}},
                         {"shading", {{"enabled", true}}},
                         {"sampling", {{"filter", "linear_fp32"}, {"gradient", gradient}}}};
        if (function == "isosurface") {
            p["isosurface"] = {{"values", {{{"value", 300}, {"opacity", 0.7}}}}};
        }
        return p;
    }
    double off(const LiveVolume& volume, nlohmann::json p) {
        p["sampling"]["gradient"] = "central";
        const Shot central = stage_.cast(volume, p, look_);
        p["sampling"]["gradient"] = "precomputed";
        const Shot kept = stage_.cast(volume, p, look_);
        nlohmann::json flat = p;
        flat["shading"]["enabled"] = false;
        if (p["function"] == "composite") {
            EXPECT_GT(difference(central.image, stage_.cast(volume, flat, look_).image).max, 0.05);
        }
        return difference(central.image, kept.image).max;
    }

    VolumeStage stage_;
    Look look_{.eye_mm = {220, -480, 120}, .fov_deg = 30};
};

TEST_F(KeptGradients, ShadeAsCentralDifferencesDo) {
    const LiveVolume head(head_volume(64, 240.0));
    for (const char* function : {"composite", "isosurface"}) {
        for (const char* filter : {"linear", "linear_fp32"}) {
            nlohmann::json p = parameters(function, "central");
            p["sampling"]["filter"] = filter;
            p["volume"]["placement"] = {{"rotate_deg", {20, -70, 130}}, {"scale", {1.4, -0.6, 1}}};
            const double error = off(head, p);
            std::printf("  %s, %s: %.1e\n", function, filter, error);
            EXPECT_LE(error, 5e-4) << function << ' ' << filter;
        }
    }
    nlohmann::json p = parameters("composite", "central");
    p["transfer_function"]["gradient"] = {{{"gradient", 0}, {"factor", 0}},
                                          {{"gradient", 50}, {"factor", 1}}};
    EXPECT_LE(off(head, p), 2e-3) << "opacity by gradient";
}

TEST_F(KeptGradients, AreExactlyNothingInAConstantBody) {
    const LiveVolume flat(
        float_volume(glm::ivec3(12), glm::dvec3(8.0), [](const glm::dvec3&) { return 900.0; }));
    nlohmann::json p = parameters("composite", "central");
    p["transfer_function"]["points"] = {{{"value", 900}, {"opacity", 0.01}, {"colour", {0.9, 0.6, 0.5}}}};
    const Shot central = stage_.cast(flat, p, look_);
    p["sampling"]["gradient"] = "precomputed";
    EXPECT_TRUE(same_bits(central, stage_.cast(flat, p, look_)));
    // A step in one corner sets the scale; elsewhere there is still none.
    const LiveVolume step(float_volume(glm::ivec3(12), glm::dvec3(8.0), [](const glm::dvec3& p) {
        return p.x > 40 && p.y > 40 && p.z > 40 ? 1000.0 : 900.0;
    }));
    p["crop"] = {{"size", {9, 9, 9}}};
    const Shot kept = stage_.cast(step, p, look_);
    p["sampling"]["gradient"] = "central";
    EXPECT_TRUE(same_bits(stage_.cast(step, p, look_), kept));
}

/// Half a voxel lies beyond the outermost centres, where one of the two values of a difference goes on alone.
TEST_F(KeptGradients, AreCentralDifferencesUpToTheFaces) {
    const LiveVolume noise(noise_volume({6, 7, 5}, glm::dvec3(30.0, 25.0, 40.0), 5));
    nlohmann::json p = parameters("composite", "central");
    p["transfer_function"]["points"] = {{{"value", 0}, {"opacity", 0.9}, {"colour", {0.9, 0.6, 0.5}}}};
    p["shading"]["two_sided"] = true;
    EXPECT_LE(off(noise, p), 1e-3) << "opaque from the faces on";
    p["transfer_function"]["points"][0]["opacity"] = 0.01;
    EXPECT_LE(off(noise, p), 5e-4);
}

TEST_F(KeptGradients, FollowALiveVolume) {
    LiveVolume head(head_volume(32, 240.0));
    const nlohmann::json p = parameters("composite", "precomputed");
    const Shot before = stage_.cast(head, p, look_);
    const std::vector<std::byte> voxels(4 * 5 * 6 * 2, std::byte{2});
    head.update({{12, 3, 14}, {4, 5, 6}}, voxels);
    const Shot after = stage_.cast_again(head, before.view, glm::ivec2(64));
    EXPECT_FALSE(same_bits(before, after));
    VolumeStage fresh;
    EXPECT_LE(difference(after.image, fresh.cast(LiveVolume(head.volume()), p, look_).image).max, 2e-3);
}

/// A voxel far out of the range must not leave its steps to all others when it is gone.
TEST_F(KeptGradients, AreFineAgainWhenASteepPlaceIsGone) {
    LiveVolume noise(noise_volume(glm::ivec3(8), glm::dvec3(25.0), 9));
    nlohmann::json p = parameters("composite", "precomputed");
    p["transfer_function"]["points"] = {{{"value", 0}, {"opacity", 0.01}, {"colour", {0.9, 0.6, 0.5}}}};
    const Shot before = stage_.cast(noise, p, look_);
    const std::vector<std::byte> was(noise.volume().voxels.begin(), noise.volume().voxels.begin() + 4);
    const float spike = 1e9F;
    noise.update({glm::ivec3(0), glm::ivec3(1)}, std::as_bytes(std::span(&spike, 1)));
    const Shot spiked = stage_.cast_again(noise, before.view, glm::ivec2(64));
    EXPECT_GT(difference(before.image, spiked.image).max, 0.01);
    noise.update({glm::ivec3(0), glm::ivec3(1)}, was);
    EXPECT_TRUE(same_bits(stage_.cast_again(noise, before.view, glm::ivec2(64)), before));
}

/// Around rings, past the ends of sectors, and where a box that changes touches a seam.
TEST_F(KeptGradients, OfSectorsAreCentralDifferencesAcrossTheSeam) {
    nlohmann::json p{{"transfer_function",
                      {{"points",
                        {{{"value", 0}, {"opacity", 0.0}, {"colour", {0.8, 0.5, 0.4}}},
                         {{"value", 1}, {"opacity", 0.3}, {"colour", {0.9, 0.6, 0.5}}}}}}},
                     {"shading", {{"enabled", true}}},
                     {"sampling", {{"filter", "linear_fp32"}, {"gradient", "central"}}}};
    constexpr std::array<std::string_view, 3> wanted{"ring", "gap", "ball"};
    for (const NamedShape& named : some_shapes()) {
        if (std::ranges::find(wanted, named.name) == wanted.end()) {
            continue;
        }
        SCOPED_TRACE(named.name);
        const bool cylinder = named.shape.kind == VolumeKind::cylindrical;
        LiveVolume volume(
            sector_noise(named.shape, cylinder ? glm::ivec3(14, 30, 12) : glm::ivec3(30, 16, 14), 11));
        const glm::dvec3 centre = sector_centre(volume.volume().grid);
        look_ = {.eye_mm = centre + glm::dvec3(110, -150, 80), .target_mm = centre, .fov_deg = 34};
        p["sampling"]["gradient"] = "central";
        const Shot central = stage_.cast(volume, p, look_);
        p["sampling"]["gradient"] = "precomputed";
        const Shot kept = stage_.cast(volume, p, look_);
        EXPECT_LE(difference(central.image, kept.image).max, 5e-4);
        VoxelBox change{glm::ivec3(0), volume.volume().grid.dims};
        change.size[cylinder ? 1 : 0] = 2;  // first angles, which a ring's last ones border on
        const std::vector<float> values(
            static_cast<std::size_t>(change.size.x) * static_cast<std::size_t>(change.size.y * change.size.z),
            0.9F);
        volume.update(change, std::as_bytes(std::span(values)));
        const Shot after = stage_.cast_again(volume, kept.view, glm::ivec2(64));
        EXPECT_FALSE(same_bits(kept, after));
        const Shot anew = stage_.cast(LiveVolume(volume.volume()), p, look_);
        EXPECT_LE(difference(after.image, anew.image).max, 1e-3);
    }
}

TEST_F(KeptGradients, AreNotUsedWithAnAtlasAndRefusedWithCubicFilters) {
    const LiveVolume head(head_volume(32, 240.0));
    nlohmann::json p = parameters("composite", "precomputed");
    p["volume"]["storage"] = "atlas";
    const Shot kept = stage_.cast(head, p, look_);
    p["sampling"]["gradient"] = "central";
    EXPECT_TRUE(same_bits(kept, stage_.cast(head, p, look_)));
    p["sampling"]["gradient"] = "precomputed";
    for (const char* filter : {"nearest", "bspline", "catmull_rom_fp32"}) {
        p["sampling"]["filter"] = filter;
        EXPECT_THROW((void)stage_.cast(head, p, look_), Error) << filter;
    }
}

}  // namespace
}  // namespace viscera::test

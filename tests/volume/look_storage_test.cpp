// Labels and overlay beside a volume, as 3-D textures and as slices on pages.

#include <gtest/gtest.h>

#include "effects/volume/gpu_volume.h"
#include "engine/core/error.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/sector_stage.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;

class LookStorage : public testing::Test {
  protected:
    void TearDown() override { EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front(); }

    Image shot(const LiveVolume& volume, const LiveVolume& labels, const LiveVolume& hue,
               const json& parameters, const Look& look, std::string_view storage) {
        json p = parameters;
        p["volume"]["storage"] = storage;
        stage_.make_current();
        stage_.load(mixed_scene(json::array(), p, to_json(look), 48, 48));
        stage_.renderer().keep({"volume.colour"});
        const std::array<HostVolume, 3> given{HostVolume{"host", &volume}, HostVolume{"labels", &labels},
                                              HostVolume{"hue", &hue}};
        Frame frame = stage_.renderer().still(0.0);
        frame.volumes = given;
        stage_.renderer().render(frame);
        return stage_.renderer().read("volume.colour");
    }

    static json parameters(const json& function) {
        return {{"transfer_function", function},
                {"labels",
                 {{"host", "labels"},
                  {"segments", {{{"id", 1}, {"opacity_factor", 0.4}}, {{"id", 2}, {"visible", false}}}}}},
                {"overlay", {{"host", "hue"}, {"strength", 0.8}}},
                {"sampling", {{"filter", "linear_fp32"}}}};
    }

    Stage stage_;
};

TEST_F(LookStorage, SlicesShowWhatTexturesShow) {
    const LiveVolume volume(shell_volume(24, 8.0));
    const LiveVolume labels(byte_volume(20, 9.0, [](const glm::dvec3& p) {
        return p.x < 20 ? 1.0 : p.z > 9 ? 2.0 : 0.0;
    }));
    const LiveVolume hue(byte_volume(9, 20.0, [](const glm::dvec3& p) { return 120.0 + p.x - 0.4 * p.z; }));
    const Look look{.eye_mm = {150, -460, 90}};
    const json p = parameters(shell_function());
    const Image texture = shot(volume, labels, hue, p, look, "texture_3d");
    const Image slices = shot(volume, labels, hue, p, look, "atlas");
    // The texture unit places samples of the overlay on a page more coarsely; labels and volume do not go
    // through it.
    EXPECT_LE(difference(texture, slices).max, 1e-4);
    json plain = p;
    plain.erase("overlay");
    EXPECT_EQ(difference(shot(volume, labels, hue, plain, look, "texture_3d"),
                         shot(volume, labels, hue, plain, look, "atlas"))
                  .max,
              0.0);
    EXPECT_GT(difference(texture, shot(volume, labels, hue, plain, look, "texture_3d")).max, 0.05);
}

/// An overlay of the volume's own shape goes on across the seam.
TEST_F(LookStorage, RingsGoOnAcrossTheSeam) {
    for (const NamedShape& named : some_shapes()) {
        if (std::string_view(named.name) != "ring" && std::string_view(named.name) != "ball") {
            continue;
        }
        SCOPED_TRACE(named.name);
        const bool cylinder = named.shape.kind == VolumeKind::cylindrical;
        const auto dims = [&](int fine) {
            return cylinder ? glm::ivec3(10, 2 * fine, 8) : glm::ivec3(2 * fine, fine, 8);
        };
        const LiveVolume volume(sector_noise(named.shape, dims(16), 3));
        const LiveVolume hue(sector_noise(named.shape, dims(7), 4));
        const LiveVolume labels(
            sector_volume(named.shape, dims(9), [](const glm::dvec3& p) { return p.x < 5 ? 1.0 : 0.0; }));
        const glm::dvec3 centre = sector_centre(volume.volume().grid);
        const Look look{.eye_mm = centre + glm::dvec3(110, -150, 80), .target_mm = centre, .fov_deg = 34};
        const json p = parameters({{"points",
                                    {{{"value", 0}, {"opacity", 0.0}, {"colour", {0.8, 0.5, 0.4}}},
                                     {{"value", 1}, {"opacity", 0.3}, {"colour", {0.9, 0.6, 0.5}}}}}});
        const Image texture = shot(volume, labels, hue, p, look, "texture_3d");
        EXPECT_LE(difference(texture, shot(volume, labels, hue, p, look, "atlas")).max, 1e-3);
        EXPECT_GT(difference(texture, texture).seen, 200U);
    }
}

/// Labels or an overlay beyond the limit of 3-D textures take the volume with them.
TEST_F(LookStorage, WhatIsTooLargeForATextureComesAsSlices) {
    stage_.make_current();
    const auto gl = gl::Functions::load(stage_.context().proc_address());
    const int limit = volume::TextureLimits::query(*gl).side_3d;
    const int many = 2100;
    if (many <= limit) {
        GTEST_SKIP() << "this device holds it as a 3-D texture";
    }
    const LiveVolume volume(shell_volume(16, 12.0));
    const double thin_mm = 192.0 / many;
    const auto stack = [&](const auto& value) {
        return LiveVolume(float_volume({3, 3, many}, {64.0, 64.0, thin_mm}, value));
    };
    const auto label = [](const glm::dvec3& p) { return p.z < 0 ? 1.0 : 0.0; };
    const LiveVolume fine = stack(label);
    const LiveVolume coarse(float_volume({3, 3, 2}, {64.0, 64.0, 96.0}, label));
    const LiveVolume hue(byte_volume(4, 48.0, [](const glm::dvec3&) { return 77.0; }));
    const Look look{.eye_mm = {150, -460, 90}};
    const json p = parameters(shell_function());
    EXPECT_LE(
        difference(shot(volume, fine, hue, p, look, "automatic"), shot(volume, coarse, hue, p, look, "atlas"))
            .above,
        3U);  // a sample on the border
    EXPECT_NO_THROW((void)shot(volume, coarse, fine, p, look, "automatic"));
    EXPECT_THROW((void)shot(volume, coarse, fine, p, look, "texture_3d"), Error);
}

}  // namespace
}  // namespace viscera::test

// What segments do to ray functions that compose no colours: hidden ones are left out, as if nothing were
// there.

#include <cmath>

#include <gtest/gtest.h>

#include "tests/volume/mixed_scene.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;

constexpr double bone = 230.0;

/// Vessels beside a block as bright as bone, or a crumb of it, so that the range of values stays.
Volume vessels_and_block(bool whole) {
    return byte_volume(32, 4.0, [whole](const glm::dvec3& p) {
        const double vessel = 150.0 * std::exp(-(p.x * p.x + p.z * p.z) / 150.0) +
                              110.0 * std::exp(-std::pow(p.x - 0.6 * p.y + 10.0, 2) / 60.0);
        const bool inside = whole ? std::abs(p.z - 40.0) < 14.0 && std::abs(p.x) < 30.0
                                  : glm::distance(p, glm::dvec3(2.0, 2.0, 42.0)) < 1.0;
        return inside ? bone : std::min(vessel, 220.0);
    });
}

/// The block with all voxels that a value between voxels could take from it.
Volume block_labels() {
    return byte_volume(32, 4.0, [](const glm::dvec3& p) {
        return std::abs(p.z - 40.0) < 20.0 && std::abs(p.x) < 36.0 ? 7.0 : 0.0;
    });
}

class LabelProjection : public testing::Test {
  protected:
    void TearDown() override { EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front(); }
    Shot shot(const LiveVolume& volume, json parameters, const Look& look, const json& segments) {
        parameters["labels"] = {{"host", "labels"}, {"segments", segments}};
        parameters["volume"]["host"] = "host";
        stage_.make_current();
        stage_.load(mixed_scene(json::array(), parameters, to_json(look), 64, 64));
        stage_.renderer().keep({"volume.colour"});
        const std::array<HostVolume, 2> given{HostVolume{"host", &volume}, HostVolume{"labels", &labels_}};
        Frame frame = stage_.renderer().still(0.0);
        frame.volumes = given;
        stage_.renderer().render(frame);
        return {stage_.renderer().read("volume.colour"), frame.eye()};
    }
    static json function(std::string_view name, std::string_view scheme) {
        json p{{"function", name},
               {"transfer_function", shell_function()},
               {"sampling", {{"scheme", scheme}}},
               {"xray", {{"water_attenuation_per_mm", 0.004}, {"negative", false}}}};
        if (name == "isosurface") {
            p["isosurface"] = {
                {"values",
                 {{{"value", 80}, {"opacity", 0.4}}, {{"value", 200}, {"colour", {0.9, 0.9, 0.8}}}}}};
        }
        return p;
    }

    Stage stage_;
    LiveVolume labels_{block_labels()};
    LiveVolume with_{vessels_and_block(true)};
    LiveVolume without_{vessels_and_block(false)};
    Look look_{.eye_mm = {60, -500, 120}, .fov_deg = 18};
};

/// Bone is taken out of an angiogram: what it held changes no bit of the picture any more.
TEST_F(LabelProjection, WhatIsHiddenIsAsIfItWereNotThere) {
    const json hidden{{{"id", 7}, {"visible", false}}};
    for (const char* name : {"mip", "minip", "average", "xray", "isosurface"}) {
        for (const char* scheme : {"midpoint", "gauss", "cell"}) {
            SCOPED_TRACE(std::string(name) + ", " + scheme);
            json p = function(name, scheme);
            const Shot seen = shot(with_, p, look_, json::array());
            const Shot bare = shot(with_, p, look_, hidden);
            EXPECT_TRUE(same_bits(bare, shot(without_, p, look_, hidden)));
            EXPECT_GT(difference(bare.image, seen.image).max, 0.02);
            EXPECT_TRUE(same_bits(seen, shot(with_, p, look_, {{{"id", 7}, {"opacity_factor", 0.5}}})) ==
                        (std::string_view(name) != "xray"));
            p["sampling"]["skip"] = false;
            EXPECT_TRUE(same_bits(bare, shot(with_, p, look_, hidden)));
        }
    }
}

/// A threshold and a hidden segment together; where all is hidden nothing is to be seen.
TEST_F(LabelProjection, HidesBesideAThreshold) {
    const json hidden{{{"id", 7}, {"visible", false}}};
    for (const char* name : {"mip", "minip", "average"}) {
        json p = function(name, "gauss");
        p["threshold"] = 60;
        EXPECT_TRUE(same_bits(shot(with_, p, look_, hidden), shot(without_, p, look_, hidden))) << name;
    }
    json p = function("mip", "midpoint");
    const LiveVolume all(byte_volume(32, 4.0, [](const glm::dvec3&) { return 7.0; }));
    labels_.replace(all.volume());
    const Shot nothing = shot(with_, p, look_, hidden);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            ASSERT_EQ(nothing.at(x, y), glm::dvec4(0.0));
        }
    }
}

/// Attenuation of water by the law of Lambert and Beer: half of the way counts by its segment's factor.
TEST_F(LabelProjection, AFactorThinsAnXray) {
    const LiveVolume water(byte_volume(16, 4.0, [](const glm::dvec3&) { return 0.0; }));
    labels_.replace(byte_volume(16, 4.0, [](const glm::dvec3& p) { return p.y > 0.0 ? 7.0 : 0.0; }));
    constexpr double mu = 0.01;
    for (const double factor : {0.0, 0.25, 3.0}) {
        json p = function("xray", "gauss");
        p["sampling"]["step"] = 0.5;
        p["xray"]["water_attenuation_per_mm"] = mu;
        const Shot shown = shot(water, p, {.eye_mm = {0, -300, 0}, .orthographic_mm = 50.0},
                                {{{"id", 7}, {"opacity_factor", factor}}});
        EXPECT_NEAR(shown.at(32, 32).x, std::exp(-mu * 32.0 * (1.0 + factor)), 1e-5) << factor;
    }
}

/// Surfaces take the colour of their segment.
TEST_F(LabelProjection, SurfacesAreTintedByTheirSegment) {
    json p = function("isosurface", "gauss");
    p["isosurface"] = {{"values", {{{"value", 200}, {"colour", {0.9, 0.9, 0.8}}}}},
                       {"lighting", {{"ambient", 1}, {"diffuse", 0}, {"specular", 0}}}};
    const auto greenest = [&](const json& segments) {
        const Shot shown = shot(with_, p, look_, segments);
        double most = 0.0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                most = std::max(most, shown.at(x, y).y - shown.at(x, y).x);
            }
        }
        return most;
    };
    EXPECT_NEAR(greenest(json::array()), 0.0, 1e-6);
    EXPECT_NEAR(greenest({{{"id", 7}, {"colour", {0.1, 0.8, 0.2}}}}), 0.7, 1e-5);
    EXPECT_NEAR(greenest({{{"id", 7}, {"colour", {0.1, 0.8, 0.2}}, {"colour_weight", 0.5}}}), 0.35, 1e-5);
}

}  // namespace
}  // namespace viscera::test

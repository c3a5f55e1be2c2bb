// Shadows and ambient occlusion of segments: as they are seen.

#include <cmath>

#include <gtest/gtest.h>

#include "effects/volume/light_volume.h"
#include "tests/volume/mixed_scene.h"
#include "tests/volume/volume_stage.h"

namespace viscera::test {
namespace {

using nlohmann::json;

class LabelLight : public testing::Test {
  protected:
    void TearDown() override { EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front(); }
    Shot shot(const LiveVolume& volume, const LiveVolume& labels, json parameters, const Look& look) {
        parameters["volume"]["host"] = "host";
        stage_.make_current();
        stage_.load(mixed_scene(json::array(), parameters, to_json(look), 64, 64));
        stage_.renderer().keep({"volume.colour"});
        return again(volume, labels);
    }
    /// The loaded scene once more.
    Shot again(const LiveVolume& volume, const LiveVolume& labels) {
        const std::array<HostVolume, 2> given{HostVolume{"host", &volume}, HostVolume{"labels", &labels}};
        Frame frame = stage_.renderer().still(0.0);
        frame.volumes = given;
        stage_.renderer().render(frame);
        return {stage_.renderer().read("volume.colour"), frame.eye()};
    }

    Stage stage_;
};

/// A ball under a plate.
Volume ball_and_plate(bool plate) {
    return byte_volume(32, 4.0, [plate](const glm::dvec3& p) {
        const double ball = 200.0 / (1.0 + std::exp((glm::length(p + glm::dvec3(0, 0, 20)) - 30.0) / 3.0));
        return plate && std::abs(p.z - 34.0) < 6.0 ? 190.0 : ball;
    });
}

json lit_ball() {
    return {{"transfer_function", shell_function()},
            {"shading",
             {{"enabled", true},
              {"lights", {{{"direction", {0.2, -0.3, 1}}}}},
              {"light_volume", {{"shadow", 1.0}, {"ambient_occlusion", 0.7}, {"resolution", 32}}}}}};
}

/// What is hidden is as if it were not there, bit by bit.
TEST_F(LabelLight, WhatIsHiddenThrowsNoShadow) {
    const LiveVolume with(ball_and_plate(true));
    const LiveVolume without(ball_and_plate(false));
    const LiveVolume labels(byte_volume(32, 4.0, [](const glm::dvec3& p) { return p.z > 20.0 ? 5.0 : 0.0; }));
    const Look look{.eye_mm = {150, -400, -60}, .target_mm = {0, 0, -10}, .fov_deg = 18};
    json p = lit_ball();
    p["labels"] = {{"host", "labels"}, {"segments", json::array()}};
    const Shot dark = shot(with, labels, p, look);
    p["labels"]["segments"] = {{{"id", 5}, {"visible", false}}};
    const Shot hidden = shot(with, labels, p, look);
    EXPECT_TRUE(same_bits(hidden, shot(without, labels, p, look)));
    EXPECT_GT(difference(hidden.image, dark.image).max, 0.1);
    p["sampling"]["skip"] = false;
    EXPECT_TRUE(same_bits(hidden, shot(with, labels, p, look)));
}

TEST_F(LabelLight, FollowsLabelsThatChange) {
    const LiveVolume volume(ball_and_plate(true));
    LiveVolume labels(byte_volume(32, 4.0, [](const glm::dvec3& p) { return p.z > 20.0 ? 5.0 : 0.0; }));
    const Look look{.eye_mm = {150, -400, -60}, .target_mm = {0, 0, -10}, .fov_deg = 18};
    json p = lit_ball();
    p["labels"] = {{"host", "labels"}, {"segments", {{{"id", 5}, {"visible", false}}}}};
    const Shot before = shot(volume, labels, p, look);
    labels.update({{8, 8, 21}, {16, 16, 11}}, std::vector<std::byte>(std::size_t{16} * 16 * 11));
    const Shot after = again(volume, labels);
    EXPECT_FALSE(same_bits(before, after));
    EXPECT_TRUE(same_bits(after, LabelLight::shot(volume, LiveVolume(labels.volume()), p, look)));
}

/// Ambient light on an opaque body under segments that let through, beside the extinction that each place
/// has, in double precision.
TEST_F(LabelLight, SegmentsTakeLightByTheirOwnLooks) {
    constexpr int n = 24;
    const LiveVolume volume(byte_volume(n, 4.0, [](const glm::dvec3&) { return 100.0; }));
    const LiveVolume labels(byte_volume(12, 8.0, [](const glm::dvec3& p) {
        return p.z < 0.0 ? 0.0 : p.x < 0.0 ? 7.0 : 8.0;
    }));
    const double opaque = 0.9999999;
    const json p{
        {"transfer_function", {{"points", {{{"value", 0}, {"colour", {1, 1, 1}}, {"opacity", opaque}}}}}},
        {"labels",
         {{"host", "labels"},
          {"segments",
           {{{"id", 7}, {"opacity_factor", 0.001}},
            {{"id", 8},
             {"opacity_factor", 2.0},
             {"points", {{{"value", 0}, {"opacity", 0.0}}, {{"value", 200}, {"opacity", 0.02}}}}}}}}},
        {"sampling", {{"step", 1}, {"scheme", "midpoint"}}},
        {"shading",
         {{"enabled", true},
          {"lighting", {{"ambient", 1}, {"diffuse", 0}, {"specular", 0}}},
          {"light_volume", {{"ambient_occlusion", 0.8}, {"resolution", n}, {"radius_mm", 40}}}}}};
    const Shot shown =
        shot(volume, labels, p, {.eye_mm = {90, -300, -200}, .target_mm = {0, 0, -24}, .fov_deg = 20});
    const glm::dmat4 box = volume.volume().grid.texture_to_world();
    volume::ExtinctionGrid grid{.dims = glm::ivec3(n), .texture_to_world = box};
    for (int i = 0; i < n * n * n; ++i) {
        const glm::dvec3 at = 4.0 * (glm::dvec3(i % n, i / n % n, i / n / n) - 0.5 * (n - 1));
        const double body = -std::log1p(-opaque);
        const double thin = at.x < 0.0 ? 0.001 * body : 2.0 * -std::log1p(-0.01);
        grid.per_mm.push_back(static_cast<float>(at.z < 0.0 ? body : thin));
    }
    const volume::LightVolumeParams how{.ambient_occlusion = 0.8, .resolution = n, .radius_mm = 40.0};
    const std::vector<glm::vec2> light = volume::light_volume(grid, how, glm::dvec4(0, 0, 1, 0));
    std::ranges::transform(light, grid.per_mm.begin(), [](const glm::vec2& cell) { return cell.y; });
    double least = 1.0;
    double most = 0.0;
    const Miss m = miss(shown, [&](const reference::Ray& ray) -> std::optional<glm::dvec4> {
        const auto interval = reference::intersect(ray, box);
        if (!interval) {
            return std::nullopt;
        }
        const glm::dvec3 at = ray.at(interval->begin + 0.5 * std::min(4.0, interval->length()));
        if (at.z > -0.1 || interval->length() < 4.0) {
            return std::nullopt;
        }
        const double arrives = grid.at(glm::inverse(box) * glm::dvec4(at, 1.0));
        least = std::min(least, arrives);
        most = std::max(most, arrives);
        return glm::dvec4(glm::dvec3(arrives), 1.0);
    });
    EXPECT_GT(m.pixels, 500);
    EXPECT_GT(most - least, 0.05);
    EXPECT_LE(m.worst, 1e-5) << m.x << ' ' << m.y;
}

}  // namespace
}  // namespace viscera::test

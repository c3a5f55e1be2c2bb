#include <cmath>

#include <gtest/gtest.h>

#include "tests/volume/mixed_scene.h"

// What places look like in pictures, beside formulas in double precision.
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int look_side = 64;

/// A picture from several host volumes.
Image shot(Stage& stage, const json& scene, std::span<const HostVolume> volumes,
           FrameReport* report = nullptr) {
    stage.make_current();
    stage.load(scene);
    stage.renderer().keep({"volume.colour"});
    Frame frame = stage.renderer().still(0.0);
    frame.volumes = volumes;
    const FrameReport& made = stage.renderer().render(frame);
    if (report != nullptr) {
        *report = made;
    }
    return stage.renderer().read("volume.colour");
}

json scene(json parameters, const json& camera) {
    return mixed_scene(json::array(), std::move(parameters), camera, look_side, look_side);
}

/// Everything seen alike.
json even_function(double opacity = 0.02, const json& colour = {0.8, 0.5, 0.2}) {
    return {{"points", {{{"value", 0}, {"colour", colour}, {"opacity", opacity}}}}};
}

glm::dvec4 pixel(const Image& image, int x, int y) {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2), image.at(x, y, 3)};
}

/// Values that rise along a direction; spacing differs from axis to axis.
Volume ramp_volume(const glm::dvec3& rise) {
    Volume volume;
    volume.grid.dims = {20, 16, 24};
    volume.grid.spacing_mm = {2.0, 4.0, 1.5};
    volume.grid.origin_mm = -0.5 * volume.grid.spacing_mm * glm::dvec3(volume.grid.dims - 1);
    volume.type = ScalarType::f32;
    for (int i = 0; i < 20 * 16 * 24; ++i) {
        const glm::dvec3 p =
            volume.grid.origin_mm + volume.grid.spacing_mm * glm::dvec3(i % 20, i / 20 % 16, i / 320);
        const auto value = static_cast<float>(glm::dot(rise, p));
        const auto bytes = std::as_bytes(std::span(&value, 1));
        volume.voxels.insert(volume.voxels.end(), bytes.begin(), bytes.end());
    }
    return volume;
}

class LookPicture : public testing::Test {
  protected:
    void TearDown() override { EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front(); }
    Stage stage_;
};

/// Opacity per reference length is a factor times the value: half of either is the same.
TEST_F(LookPicture, accumulation_heeds_opacity_by_gradient) {
    const LiveVolume volume(ramp_volume({1.0, -2.0, 0.5}));
    const HostVolume given{"host", &volume};
    const auto with = [&](double opacity, const json& gradient) {
        return shot(stage_,
                    scene({{"function", "accumulate"},
                           {"accumulate", {{"opacity", opacity}}},
                           {"transfer_function", {{"gradient", gradient}}}},
                          camera_at({100.0, -320.0, 60.0})),
                    std::span(&given, 1));
    };
    const json half{{{"gradient", 0}, {"factor", 0.5}}, {{"gradient", 10}, {"factor", 0.5}}};
    const Difference off = difference(with(10.0, half), with(5.0, json::array()));
    EXPECT_GT(off.seen, 200U);
    EXPECT_LE(off.max, 1e-5);
    const json steep{{{"gradient", 3}, {"factor", 0}}, {{"gradient", 10}, {"factor", 1}}};  // the ramp's: 2.3
    EXPECT_EQ(difference(with(10.0, steep), with(0.0, json::array())).max, 0.0);
}

TEST_F(LookPicture, shading_is_blinn_phong_of_the_gradient_in_the_world) {
    const glm::dvec3 rise(1.0, -2.0, 0.5);
    const LiveVolume volume(ramp_volume(rise));
    const HostVolume given{"host", &volume};
    const glm::dvec3 light = glm::normalize(glm::dvec3(-1.0, 1.0, 0.4));
    const glm::dvec3 colour(0.8, 0.5, 0.2);
    for (const bool at_eye : {false, true}) {
        json shading = {
            {"enabled", true},
            {"lighting", {{"ambient", 0.1}, {"diffuse", 0.6}, {"specular", 0.4}, {"shininess", 12}}}};
        if (!at_eye) {
            shading["lights"] = {{{"direction", {-1.0, 1.0, 0.4}}, {"colour", {1.0, 0.9, 0.8}}}};
        }
        json camera = camera_at({150, -260, 90});
        camera["vertical_fov_deg"] = 12;
        const Image image = shot(stage_,
                                 scene({{"transfer_function", even_function()},
                                        {"crop", {{"first", {2, 2, 2}}, {"size", {16, 12, 20}}}},
                                        {"shading", shading}},
                                       camera),
                                 std::span(&given, 1));
        const View view = stage_.renderer().still(0.0).eye();
        const glm::dvec3 normal = -glm::normalize(rise);
        int seen = 0;
        for (int y = 0; y < look_side; ++y) {
            for (int x = 0; x < look_side; ++x) {
                const glm::dvec4 got = pixel(image, x, y);
                if (got.a < 0.05) {
                    continue;
                }
                ++seen;
                const glm::dvec3 towards_eye = -pixel_ray(view, x, y, look_side, look_side).direction;
                const glm::dvec3 l = at_eye ? towards_eye : light;
                const glm::dvec3 h = glm::normalize(l + towards_eye);
                const glm::dvec3 of_light = at_eye ? glm::dvec3(1.0) : glm::dvec3(1.0, 0.9, 0.8);
                const double facing = std::abs(glm::dot(normal, l));
                const double gloss = std::pow(std::abs(glm::dot(normal, h)), 12.0);
                const glm::dvec3 wanted = 0.1 * colour + of_light * (0.6 * facing * colour + 0.4 * gloss);
                for (int c = 0; c < 3; ++c) {
                    ASSERT_NEAR(got[c] / got.a, wanted[c], 2e-5) << x << ", " << y;
                }
            }
        }
        EXPECT_GT(seen, 300);
    }
}

TEST_F(LookPicture, without_a_gradient_only_ambient_light) {
    const LiveVolume volume(byte_volume(8, 10.0, [](const glm::dvec3&) { return 100.0; }));
    const HostVolume given{"host", &volume};
    const Image image = shot(stage_,
                             scene({{"transfer_function", even_function()},
                                    {"shading", {{"enabled", true}, {"lighting", {{"ambient", 0.25}}}}}},
                                   camera_at({150, -260, 90})),
                             std::span(&given, 1));
    const glm::dvec4 middle = pixel(image, look_side / 2, look_side / 2);
    ASSERT_GT(middle.a, 0.3);
    EXPECT_NEAR(middle.r / middle.a, 0.25 * 0.8, 1e-6);
    EXPECT_NEAR(middle.b / middle.a, 0.25 * 0.2, 1e-6);
}

TEST_F(LookPicture, gradient_opacity_is_a_factor_on_the_opacity) {
    const glm::dvec3 rise(1.0, -2.0, 0.5);
    const LiveVolume volume(ramp_volume(rise));
    const HostVolume given{"host", &volume};
    json function = even_function(0.04);
    const json camera = orthographic_at({150, -260, 90});
    const json crop = {{"first", {2, 2, 2}}, {"size", {16, 12, 20}}};
    const Image plain =
        shot(stage_, scene({{"transfer_function", function}, {"crop", crop}}, camera), std::span(&given, 1));
    // Two thirds of the way to the magnitude at which everything is seen.
    function["gradient"] = {{{"gradient", 0}, {"factor", 0}},
                            {{"gradient", 1.5 * glm::length(rise)}, {"factor", 1}}};
    const Image image =
        shot(stage_, scene({{"transfer_function", function}, {"crop", crop}}, camera), std::span(&given, 1));
    const double a = pixel(plain, look_side / 2, look_side / 2).a;
    const double length_mm = std::log1p(-a) / std::log1p(-0.04);
    EXPECT_NEAR(pixel(image, look_side / 2, look_side / 2).a,
                1.0 - std::pow(1.0 - 0.04 * 2.0 / 3.0, length_mm), 2e-5);
}

TEST_F(LookPicture, clipped_chords_are_exact) {
    const LiveVolume volume(byte_volume(16, 5.0, [](const glm::dvec3&) { return 100.0; }));
    const HostVolume given{"host", &volume};
    const json planes = {{{"point_mm", {3, -5, 2}}, {"normal", {1, 2, -0.5}}},
                         {{"point_mm", {20, 0, 0}}, {"normal", {-1, 0.2, 0}}}};
    for (const json& camera : {camera_at({150, -260, 90}), orthographic_at({-90, 260, 190})}) {
        const Image image =
            shot(stage_, scene({{"transfer_function", even_function()}, {"clip_planes", planes}}, camera),
                 std::span(&given, 1));
        const View view = stage_.renderer().still(0.0).eye();
        int cut = 0;
        for (int y = 0; y < look_side; ++y) {
            for (int x = 0; x < look_side; ++x) {
                const PixelRay ray = pixel_ray(view, x, y, look_side, look_side);
                glm::dvec2 s = box_interval(ray, glm::dvec3(-40.0), glm::dvec3(40.0));
                const double whole = s.y - s.x;
                for (const json& plane : planes) {
                    const auto vec = [&](const char* key) {
                        return glm::dvec3(plane[key][0], plane[key][1], plane[key][2]);
                    };
                    const double rise = glm::dot(vec("normal"), ray.direction);
                    const double at = glm::dot(vec("normal"), vec("point_mm") - ray.origin) / rise;
                    s = rise > 0.0 ? glm::dvec2(std::max(s.x, at), s.y) : glm::dvec2(s.x, std::min(s.y, at));
                }
                const double chord = std::max(s.y - s.x, 0.0);
                cut += chord > 0.0 && chord < whole ? 1 : 0;
                ASSERT_NEAR(pixel(image, x, y).a, 1.0 - std::pow(0.98, chord), 1e-5) << x << ", " << y;
            }
        }
        EXPECT_GT(cut, 100);
    }
}

TEST_F(LookPicture, nothing_is_drawn_when_everything_is_clipped) {
    const LiveVolume volume(shell_volume(16));
    const HostVolume given{"host", &volume};
    FrameReport report;
    (void)shot(stage_,
               scene({{"transfer_function", even_function()},
                      {"clip_planes", {{{"point_mm", {0, 0, 500}}, {"normal", {0, 0, 1}}}}}},
                     camera_at({150, -260, 90})),
               std::span(&given, 1), &report);
    EXPECT_EQ(pass_of(report, "cast").reason, "everything is clipped");
}

TEST_F(LookPicture, labels_are_never_mixed) {
    const LiveVolume volume(byte_volume(16, 5.0, [](const glm::dvec3&) { return 100.0; }));
    // 1 and 200 beside each other: filtered, there would be 100 between them. A grid of its own.
    const LiveVolume labels(byte_volume(10, 8.0, [](const glm::dvec3& p) { return p.x < 0 ? 1.0 : 200.0; }));
    const std::array<HostVolume, 2> given{HostVolume{"host", &volume}, HostVolume{"labels", &labels}};
    const json look = {{"host", "labels"},
                       {"segments",
                        {{{"id", 1}, {"colour", {1, 0, 0}}},
                         {{"id", 100}, {"colour", {0, 0, 1}}},
                         {{"id", 200}, {"colour", {0, 1, 0}}, {"opacity_factor", 0.5}}}}};
    json camera = orthographic_at({0, -260, 0});
    camera["target_mm"] = {0, 0, 0};
    camera["height_mm"] = 100;
    const Image image =
        shot(stage_, scene({{"transfer_function", even_function()}, {"labels", look}}, camera), given);
    int red = 0;
    int green = 0;
    for (int x = 0; x < look_side; ++x) {
        const glm::dvec4 got = pixel(image, x, look_side / 2);
        if (got.a > 0.0) {
            EXPECT_EQ(got.b, 0.0);
            EXPECT_TRUE(got.r == 0.0 || got.g == 0.0) << x;
            red += got.r > 0.0 ? 1 : 0;
            green += got.g > 0.0 ? 1 : 0;
            EXPECT_NEAR(got.a, 1.0 - std::pow(0.98, got.r > 0.0 ? 80.0 : 40.0), 1e-5);
        }
    }
    EXPECT_NEAR(red, green, 1);
    EXPECT_GT(red, 20);
}

TEST_F(LookPicture, skipping_sees_what_only_a_label_shows) {
    const LiveVolume volume(shell_volume());
    const LiveVolume labels(
        byte_volume(24, 8.0, [](const glm::dvec3& p) { return glm::length(p) < 60.0 ? 7.0 : 0.0; }));
    const std::array<HostVolume, 2> given{HostVolume{"host", &volume}, HostVolume{"labels", &labels}};
    // The transfer function shows high values only; the segment shows low ones.
    const json function = {
        {"points", {{{"value", 190}, {"opacity", 0.0}}, {{"value", 200}, {"opacity", 0.1}}}}};
    json parameters = {{"transfer_function", function},
                       {"labels",
                        {{"host", "labels"},
                         {"segments",
                          {{{"id", 7},
                            {"points",
                             {{{"value", 20}, {"opacity", 0.0}},
                              {{"value", 30}, {"opacity", 0.05}, {"colour", {0.2, 0.9, 0.3}}},
                              {{"value", 40}, {"opacity", 0.0}}}}}}}}}};
    const json camera = camera_at({150, -460, 90});
    parameters["sampling"]["skip"] = false;
    const Image plain = shot(stage_, scene(parameters, camera), given);
    parameters["sampling"]["skip"] = true;
    EXPECT_EQ(difference(plain, shot(stage_, scene(parameters, camera), given)).max, 0.0);
    parameters.erase("labels");
    EXPECT_GT(difference(plain, shot(stage_, scene(parameters, camera), given)).max, 0.05);
}

TEST_F(LookPicture, the_overlay_gives_the_hue) {
    const LiveVolume volume(byte_volume(16, 5.0, [](const glm::dvec3&) { return 100.0; }));
    const LiveVolume overlay(byte_volume(4, 20.0, [](const glm::dvec3&) { return 50.0; }));
    const std::array<HostVolume, 2> given{HostVolume{"host", &volume}, HostVolume{"hue", &overlay}};
    const json look = {{"host", "hue"},
                       {"strength", 0.5},
                       {"points",
                        {{{"value", 0}, {"colour", {0, 0, 1}}, {"opacity", 1}},
                         {{"value", 100}, {"colour", {0, 1, 0}}, {"opacity", 1}}}}};
    const Image image =
        shot(stage_,
             scene({{"transfer_function", even_function()}, {"overlay", look}}, camera_at({150, -260, 90})),
             given);
    const glm::dvec4 got = pixel(image, look_side / 2, look_side / 2);
    ASSERT_GT(got.a, 0.3);
    // (0, 0.5, 0.5) at the brightness 0.8 is (0, 0.8, 0.8); half of the way from (0.8, 0.5, 0.2).
    EXPECT_NEAR(got.r / got.a, 0.4, 1e-3);
    EXPECT_NEAR(got.g / got.a, 0.65, 1e-3);
    EXPECT_NEAR(got.b / got.a, 0.5, 1e-3);
}

}  // namespace
}  // namespace viscera::test

#include <cmath>

#include <gtest/gtest.h>

#include "tests/volume/mixed_scene.h"

// A given depth behind where rays start, in a homogeneous volume: opacity is 1 - exp(-box_sigma length).
namespace viscera::test {
namespace {

using nlohmann::json;

constexpr double box_sigma = 0.02;
constexpr double depth_mm = 17.0;
constexpr double half_mm = 40.0;

class SubVolume : public testing::Test {
  protected:
    void TearDown() override { EXPECT_TRUE(stage_.complaints().empty()) << stage_.complaints().front(); }

    static json parameters(double depth = depth_mm) {
        return {
            {"transfer_function", {{"points", {{{"value", 0}, {"opacity", 1.0 - std::exp(-box_sigma)}}}}}},
            {"sampling", {{"termination", 0}}},
            {"sub_volume", {{"depth_mm", depth}}}};
    }
    /// start(ray): where rays begin and end without the depth; pixels with less than 1 mm are left out.
    template <class Stretch>
    void expect_depth(const Image& image, double depth, const Stretch& stretch) {
        const View view = stage_.renderer().still(0.0).eye();
        int cut = 0;
        int whole = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const glm::dvec2 s = stretch(pixel_ray(view, x, y, image.width, image.height));
                if (s.y - s.x > 0.0 && s.y - s.x < 1.0) {
                    continue;
                }
                const double length = std::clamp(s.y - s.x, 0.0, depth);
                cut += s.y - s.x > depth ? 1 : 0;
                whole += s.y - s.x > 0.0 && s.y - s.x < depth ? 1 : 0;
                ASSERT_NEAR(image.at(x, y, 3), 1.0 - std::exp(-box_sigma * length), 1e-5) << x << ", " << y;
            }
        }
        EXPECT_GT(cut, 200);
        EXPECT_GT(whole, 10);
    }

    LiveVolume volume_{byte_volume(16, 5.0, [](const glm::dvec3&) { return 100.0; })};
    Stage stage_;
};

TEST_F(SubVolume, begins_at_the_box) {
    for (const json& camera : {camera_at({150, -260, 90}), orthographic_at({-90, 260, 190})}) {
        const Image image = mixed_shot(stage_, mixed_scene(json::array(), parameters(), camera), volume_);
        expect_depth(image, depth_mm, [](const PixelRay& ray) {
            return box_interval(ray, glm::dvec3(-half_mm), glm::dvec3(half_mm));
        });
    }
}

TEST_F(SubVolume, begins_at_a_clip_plane) {
    json more = parameters();
    more["clip_planes"] = {{{"point_mm", {0, -5, 0}}, {"normal", {0.2, 1, 0}}}};
    const Image image =
        mixed_shot(stage_, mixed_scene(json::array(), more, camera_at({150, -260, 90})), volume_);
    expect_depth(image, depth_mm, [](const PixelRay& ray) {
        glm::dvec2 s = box_interval(ray, glm::dvec3(-half_mm), glm::dvec3(half_mm));
        const glm::dvec3 n(0.2, 1.0, 0.0);
        s.x = std::max(s.x, glm::dot(n, glm::dvec3(0, -5, 0) - ray.origin) / glm::dot(n, ray.direction));
        return s;
    });
}

TEST_F(SubVolume, begins_at_a_drawn_surface) {
    const TempFolder folder;
    const MeshData ball = ball_mesh(glm::vec3(5.0F, -4.0F, 3.0F), 30.0F);
    const json mesh = {{"volume", {{"host", "host"}}},
                       {"limits_mesh", folder.write("ball.obj", obj_text(ball)).string()}};
    json more = parameters();
    more["sampling"]["limits"] = "mesh";
    const Image image =
        mixed_shot(stage_,
                   mixed_scene({{{"name", "entry"}, {"effect", "volume.entry"}, {"parameters", mesh}},
                                {{"name", "exit"}, {"effect", "volume.exit"}, {"parameters", mesh}}},
                               more, camera_at({60, -220, 50})),
                   volume_);
    expect_depth(image, depth_mm, [&](const PixelRay& ray) {
        const std::vector<double> at = crossings(ray, ball);
        if (at.size() < 2) {
            return glm::dvec2(0.0);
        }
        const auto [first, last] = std::ranges::minmax(at);
        return glm::dvec2(first, last);
    });
}

TEST_F(SubVolume, of_no_depth_shows_nothing) {
    const Image image =
        mixed_shot(stage_, mixed_scene(json::array(), parameters(0.0), camera_at({150, -260, 90})), volume_);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            ASSERT_EQ(image.at(x, y, 3), 0.0F);
        }
    }
}

}  // namespace
}  // namespace viscera::test

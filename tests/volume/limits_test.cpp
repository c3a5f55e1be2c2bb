#include <gtest/gtest.h>

#include "effects/volume/limits_effect.h"
#include "tests/volume/mixed_scene.h"

namespace viscera::test {
namespace {

TEST(BoxMesh, IsClosedAndFacesOutwards) {
    const MeshData box = volume::box_mesh({0.25F, 0.0F, 0.5F}, {1.0F, 0.5F, 1.0F});
    EXPECT_DOUBLE_EQ(volume::signed_volume6(box), 6.0 * 0.75 * 0.5 * 0.5);
    MeshData turned = box;
    for (std::size_t t = 0; t < turned.indices.size(); t += 3) {
        std::swap(turned.indices[t], turned.indices[t + 1]);
    }
    EXPECT_DOUBLE_EQ(volume::signed_volume6(turned), -volume::signed_volume6(box));
    EXPECT_EQ(volume::signed_volume6(MeshData{}), 0.0);
}

class RayLimits : public testing::Test {
  protected:
    static nlohmann::json passes(const nlohmann::json& more = nlohmann::json::object()) {
        nlohmann::json parameters = more;
        parameters["volume"]["host"] = "host";
        return {{{"name", "entry"}, {"effect", "volume.entry"}, {"parameters", parameters}},
                {{"name", "exit"}, {"effect", "volume.exit"}, {"parameters", parameters}}};
    }
    static nlohmann::json cast(const char* limits, nlohmann::json more = nlohmann::json::object()) {
        more["transfer_function"] = shell_function();
        more["sampling"]["limits"] = limits;
        return more;
    }

    /// The picture between drawn faces against that between the box's planes.
    void expect_same(const nlohmann::json& camera, const nlohmann::json& crop = nlohmann::json::object(),
                     const nlohmann::json& placement = nlohmann::json::object()) {
        nlohmann::json common;
        if (!crop.empty()) {
            common["crop"] = crop;
        }
        if (!placement.empty()) {
            common["volume"]["placement"] = placement;
        }
        const Image analytic = mixed_shot(
            stage_, mixed_scene(nlohmann::json::array(), cast("analytic", common), camera), volume_);
        const Image drawn =
            mixed_shot(stage_, mixed_scene(passes(common), cast("two_pass", common), camera), volume_);
        const Difference d = difference(analytic, drawn, 1e-3);
        EXPECT_LE(d.mean, 1e-4);
        // At the box's edges coverage decides; there the way through the box is shortest.
        EXPECT_LE(d.above, 60U);
        EXPECT_GT(d.seen, 400U);
        EXPECT_EQ(stage_.complaints(), std::vector<std::string>{});
    }

    TempFolder folder_;
    int meshes_ = 0;
    LiveVolume volume_{shell_volume()};
    Stage stage_;
};

TEST_F(RayLimits, DrawnFacesGiveTheSameRaysInPerspective) {
    expect_same(camera_at({250, -380, 120}));
}

TEST_F(RayLimits, DrawnFacesGiveTheSameRaysOrthographically) {
    expect_same(orthographic_at({250, -380, 120}));
}

TEST_F(RayLimits, DrawnFacesOfACrop) {
    expect_same(camera_at({250, -380, 120}), {{"first", {10, 7, 0}}, {"size", {20.5, 30, 17}}});
}

TEST_F(RayLimits, TheEyeInside) {
    expect_same(camera_at({-30, -40, 25}, 2.0));
}

TEST_F(RayLimits, AMirroredAndTurnedVolume) {
    expect_same(camera_at({250, -380, 120}), {},
                {{"scale", {-1, 1.2, 0.8}}, {"rotate_deg", {20, 40, -10}}, {"move_mm", {10, 0, -20}}});
}

TEST_F(RayLimits, AFarPlaneThatCutsTheVolume) {
    expect_same(camera_at({250, -380, 120}, 20.0, 480.0));
}

TEST_F(RayLimits, AViewThatMirrors) {
    expect_same({{"kind", "c_arm"}, {"primary_deg", 30}, {"secondary_deg", 15}});
}

TEST_F(RayLimits, AMeshLimitsWhatIsSeen) {
    // A homogeneous volume within a ball: the chord of the ball's triangles.
    constexpr double sigma = 0.01;
    const LiveVolume whole(byte_volume(16, 10.0, [](const glm::dvec3&) { return 200.0; }));
    const double opacity = 1.0 - std::exp(-sigma);
    const auto parameters = [&](MeshData ball) {
        const std::string name = "ball" + std::to_string(meshes_++) + ".obj";
        return nlohmann::json{{"limits_mesh", folder_.write(name, obj_text(ball)).string()}};
    };
    nlohmann::json p{{"sampling", {{"limits", "mesh"}, {"termination", 0}}}};
    p["transfer_function"]["points"] = {{{"value", 0}, {"opacity", opacity}},
                                        {{"value", 255}, {"opacity", opacity}}};
    for (const bool inside_out : {false, true}) {
        for (const auto& [eye, centre] : {std::pair{glm::dvec3(60, -420, 90), glm::vec3(5, -10, 12)},
                                          // beyond the box, and about the eye
                                          std::pair{glm::dvec3(60, -420, 90), glm::vec3(60, 0, 0)},
                                          std::pair{glm::dvec3(-20, -50, 5), glm::vec3(-20, -40, 10)}}) {
            SCOPED_TRACE(testing::Message() << eye.x << " " << centre.x << " " << inside_out);
            MeshData ball = ball_mesh(centre, 40);
            if (inside_out) {
                for (std::size_t t = 0; t < ball.indices.size(); t += 3) {
                    std::swap(ball.indices[t], ball.indices[t + 1]);
                }
            }
            const Image got =
                mixed_shot(stage_, mixed_scene(passes(parameters(ball)), p, camera_at(eye, 5.0)), whole);
            const View view = stage_.renderer().still(0.0).eye();
            double worst = 0.0;
            std::size_t seen = 0;
            std::size_t edges = 0;
            for (int y = 0; y < got.height; ++y) {
                for (int x = 0; x < got.width; ++x) {
                    const PixelRay ray = pixel_ray(view, x, y, got.width, got.height);
                    const std::vector<double> at = crossings(ray, ball);
                    double length = 0.0;
                    if (at.size() > 1) {
                        const auto [first, last] = std::ranges::minmax(at);
                        const glm::dvec2 box = box_interval(ray, glm::dvec3(-80), glm::dvec3(80));
                        length = std::max(std::min(last, box.y) - std::max(first, box.x), 0.0);
                    }
                    const double error = std::abs(got.at(x, y, 3) - (1.0 - std::exp(-sigma * length)));
                    if (length < 15.0) {
                        edges += error > 1e-4 ? 1U : 0U;
                        continue;
                    }
                    ++seen;
                    worst = std::max(worst, error);
                }
            }
            EXPECT_LE(worst, 1e-5);
            EXPECT_GT(seen, 200U);
            EXPECT_LE(edges, 12U);
        }
    }
}

TEST_F(RayLimits, NoMeshInSightMeansNothingToSee) {
    const MeshData ball = ball_mesh({3000, 0, 0}, 10);
    nlohmann::json mesh{{"limits_mesh", folder_.write("ball.obj", obj_text(ball)).string()}};
    FrameReport report;
    (void)mixed_shot(stage_, mixed_scene(passes(mesh), cast("mesh"), camera_at({0, -420, 0})), volume_,
                     "volume.colour", &report);
    EXPECT_EQ(pass_of(report, "exit").status, PassStatus::idle);
    EXPECT_EQ(pass_of(report, "cast").status, PassStatus::idle);
}

TEST_F(RayLimits, AVolumeBehindTheFarPlaneIsNotSeen) {
    const Image got = mixed_shot(
        stage_, mixed_scene(passes(), cast("two_pass"), camera_at({0, -420, 0}, 20.0, 200.0)), volume_);
    EXPECT_EQ(difference(got, got).seen, 0U);
}

TEST_F(RayLimits, LimitsOfAnotherCropOrPlaceAreSaid) {
    const nlohmann::json camera = camera_at({250, -380, 120});
    const nlohmann::json crop = {{"crop", {{"first", {3, 0, 0}}}}};
    const nlohmann::json moved = {{"volume", {{"placement", {{"move_mm", {5, 0, 0}}}}}}};
    for (const nlohmann::json& other : {crop, moved}) {
        Stage stage;
        (void)mixed_shot(stage, mixed_scene(passes(other), cast("two_pass"), camera), volume_);
        ASSERT_EQ(stage.complaints().size(), 1U) << other;
        EXPECT_NE(stage.complaints()[0].find("another volume, place or crop"), std::string::npos);
        EXPECT_EQ(stage.renderer().log().faults().at("volume.other_limits"), 2U) << "entry and exit";
    }
    stage_.make_current();
}

TEST_F(RayLimits, WithoutThePassesTheSceneIsRefused) {
    EXPECT_THROW(
        (void)mixed_shot(stage_,
                         mixed_scene(nlohmann::json::array(), cast("two_pass"), camera_at({250, -380, 120})),
                         volume_),
        Error);
}

}  // namespace
}  // namespace viscera::test

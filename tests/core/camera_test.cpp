#include "engine/core/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include <glm/gtc/matrix_access.hpp>

#include "engine/core/error.h"
#include "engine/core/eyes.h"
#include "tests/core/not_finite.h"

namespace viscera {
namespace {

constexpr double tolerance = 1e-12;

CameraParams c_arm(double primary_deg, double secondary_deg) {
    CameraParams camera;
    camera.kind = CameraKind::c_arm;
    camera.primary_deg = primary_deg;
    camera.secondary_deg = secondary_deg;
    return camera;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double within) {
    EXPECT_NEAR(a.x, b.x, within);
    EXPECT_NEAR(a.y, b.y, within);
    EXPECT_NEAR(a.z, b.z, within);
}

void expect_uv(const View& view, const glm::dvec3& point_mm, double u, double v) {
    const auto uv = project_to_uv(view, point_mm);
    ASSERT_TRUE(uv);
    EXPECT_NEAR(uv->x, u, tolerance);
    EXPECT_NEAR(uv->y, v, tolerance);
}

const glm::dvec3 left{1, 0, 0};
const glm::dvec3 back{0, 1, 0};
const glm::dvec3 head{0, 0, 1};

TEST(Camera, PerspectiveShowsTargetInTheCentreAndFieldOfViewAtTheEdge) {
    CameraParams camera;  // in front of the patient, looking back
    const View view = make_view(camera, 2.0);
    EXPECT_FALSE(view.orthographic);
    EXPECT_FALSE(view.mirrored);
    expect_uv(view, camera.target_mm, 0.5, 0.5);
    const double half_mm = 600.0 * std::tan(15.0 * std::acos(-1.0) / 180.0);
    expect_uv(view, half_mm * head, 0.5, 1.0);
    expect_uv(view, -half_mm * head, 0.5, 0.0);
    expect_uv(view, 2.0 * half_mm * left, 1.0, 0.5);  // facing the patient: left is on the right
    expect_near(view.forward, back, tolerance);
    expect_near(view.direction_to({0, 0, 0}), back, tolerance);
    expect_near(view.direction_to(camera.eye_mm + 5.0 * head), head, tolerance);
    expect_near(view.direction_to(camera.eye_mm), view.forward, 0.0);
}

TEST(Camera, NearAndFarAreTheEndsOfClipSpace) {
    for (const CameraKind kind : {CameraKind::perspective, CameraKind::orthographic, CameraKind::c_arm}) {
        CameraParams camera;
        camera.kind = kind;
        camera.near_mm = 10.0;
        camera.far_mm = 2000.0;
        const View view = make_view(camera, 1.5);
        const auto depth = [&](double distance_mm) {
            const glm::dvec4 clip =
                view.view_projection() * glm::dvec4(view.eye_mm + distance_mm * view.forward, 1.0);
            return clip.z / clip.w;
        };
        EXPECT_NEAR(depth(10.0), -1.0, 1e-9);
        EXPECT_NEAR(depth(2000.0), 1.0, 1e-9);
    }
}

TEST(Camera, ViewMatrixIsRigidAndMirroringIsInTheProjection) {
    for (const double primary : {0.0, 30.0, -110.0}) {
        const View view = make_view(c_arm(primary, 25.0), 1.0);
        EXPECT_NEAR(glm::determinant(glm::dmat3(view.view)), 1.0, tolerance);
        EXPECT_TRUE(view.mirrored);
        EXPECT_LT(view.projection[0][0], 0.0);
        EXPECT_GT(view.projection[1][1], 0.0);
        EXPECT_NEAR(glm::length(glm::dvec3(view.view * glm::dvec4(view.eye_mm, 1.0))), 0.0, 1e-9);
    }
    EXPECT_GT(make_view(CameraParams{}, 1.0).projection[0][0], 0.0);
}

TEST(Camera, AViewFollowsFromAHostsMatrices) {
    for (const CameraKind kind : {CameraKind::perspective, CameraKind::orthographic, CameraKind::c_arm}) {
        CameraParams camera;
        camera.kind = kind;
        camera.eye_mm = {140.0, -500.0, 80.0};
        camera.stereo = StereoParams{.interpupillary_mm = 90.0, .convergence_mm = 300.0};
        for (const View& wanted : make_eyes(camera, 1.4).views) {
            const View made = view_of(wanted.view, wanted.projection);
            EXPECT_EQ(made.orthographic, wanted.orthographic);
            EXPECT_EQ(made.mirrored, wanted.mirrored);
            expect_near(made.eye_mm, wanted.eye_mm, 1e-9);
            expect_near(made.forward, wanted.forward, tolerance);
            // Pictures upside down, as hosts with another origin have them.
            glm::dmat4 turned = wanted.projection;
            for (int column = 0; column < 4; ++column) {
                turned[column][1] *= -1.0;
            }
            EXPECT_NE(view_of(wanted.view, turned).mirrored, wanted.mirrored);
            expect_near(view_of(wanted.view, turned).forward, wanted.forward, tolerance);
            EXPECT_THROW((void)view_of(2.0 * wanted.view, wanted.projection), Error);
            EXPECT_THROW((void)view_of(wanted.view, glm::dmat4(0.0)), Error);
            EXPECT_THROW((void)view_of(glm::dmat4(nan), wanted.projection), Error);
        }
    }
}

TEST(Camera, OrthographicKeepsHeightAtAnyDistance) {
    CameraParams camera;
    camera.kind = CameraKind::orthographic;
    camera.height_mm = 100.0;
    const View view = make_view(camera, 2.0);
    EXPECT_TRUE(view.orthographic);
    for (const double y : {-500.0, 0.0, 3000.0}) {
        expect_uv(view, y * back + 50.0 * head, 0.5, 1.0);
        expect_uv(view, y * back + 100.0 * left, 1.0, 0.5);
    }
    expect_near(view.direction_to({300, 20, -7}), back, tolerance);
    EXPECT_FALSE(project_to_uv(view, {0, -601, 0})) << "behind the eye plane";
}

TEST(Camera, CArmStandsBehindThePatientAndShowsTheCathLabsPicture) {
    const View view = make_view(c_arm(0, 0), 1.0);
    expect_near(view.eye_mm, 750.0 * back, 1e-9);
    expect_near(view.forward, -back, tolerance);
    expect_uv(view, {0, 0, 0}, 0.5, 0.5);
    EXPECT_GT(project_to_uv(view, 10.0 * head)->y, 0.5);
    EXPECT_GT(project_to_uv(view, 10.0 * left)->x, 0.5) << "the patient's left is on the right";
}

TEST(Camera, CArmAtLao90IsLateral) {
    const View view = make_view(c_arm(90, 0), 1.0);
    expect_near(view.forward, left, tolerance);  // the detector is at the patient's left
    expect_near(view.eye_mm, -750.0 * left, 1e-9);
    EXPECT_GT(project_to_uv(view, 10.0 * head)->y, 0.5);
    EXPECT_GT(project_to_uv(view, 10.0 * back)->x, 0.5) << "the spine is on the right in LAO";
    EXPECT_NEAR(project_to_uv(view, 10.0 * left)->x, 0.5, tolerance);
    EXPECT_LT(project_to_uv(make_view(c_arm(-30, 0), 1.0), 50.0 * back)->x, 0.5) << "and left in RAO";
}

TEST(Camera, CArmCranialTiltsTheDetectorToTheHead) {
    const View view = make_view(c_arm(0, 30), 1.0);
    EXPECT_NEAR(view.forward.z, 0.5, tolerance);
    EXPECT_LT(view.forward.y, 0.0);
    const View caudal = make_view(c_arm(0, -30), 1.0);
    EXPECT_NEAR(caudal.forward.z, -0.5, tolerance);
    const View axial = make_view(c_arm(40, 90), 1.0);
    expect_near(axial.forward, head, tolerance);  // up stays defined
    expect_uv(axial, {0, 0, 0}, 0.5, 0.5);
}

TEST(Camera, CArmMagnifiesBySidOverSad) {
    CameraParams camera = c_arm(33, -12);
    camera.isocentre_mm = {12, -30, 400};
    camera.source_axis_distance_mm = 800.0;
    camera.source_image_distance_mm = 1000.0;
    camera.detector_height_mm = 250.0;
    const View view = make_view(camera, 1.5);
    expect_uv(view, camera.isocentre_mm, 0.5, 0.5);
    const glm::dvec3 up = glm::row(glm::dmat3(view.view), 1);
    const glm::dvec3 right = glm::row(glm::dmat3(view.view), 0);
    const double half_mm = 0.5 * 250.0 * 800.0 / 1000.0;
    expect_uv(view, camera.isocentre_mm + half_mm * up, 0.5, 1.0);
    expect_uv(view, camera.isocentre_mm - 1.5 * half_mm * right, 1.0, 0.5);
    // The near plane cuts but does not scale.
    camera.near_mm = 300.0;
    expect_uv(make_view(camera, 1.5), camera.isocentre_mm + half_mm * up, 0.5, 1.0);
}

TEST(Camera, OrbitTurnsAboutUpThroughTheTarget) {
    CameraParams camera;
    camera.target_mm = {10, 20, 30};
    camera.eye_mm = camera.target_mm + glm::dvec3(0, -600, 50);
    camera.up = {0, 0, 2};
    camera.orbit_deg_per_s = 45.0;
    expect_near(make_view(camera, 1.0, 2.0).eye_mm, camera.target_mm + glm::dvec3(600, 0, 50), 1e-9);
    expect_near(make_view(camera, 1.0, 8.0).eye_mm, camera.eye_mm, 1e-9);
    expect_uv(make_view(camera, 1.0, 1.234), camera.target_mm, 0.5, 0.5);

    CameraParams arm = c_arm(10, 5);
    arm.orbit_deg_per_s = 20.0;
    expect_near(make_view(arm, 1.0, 3.0).eye_mm, make_view(c_arm(70, 5), 1.0).eye_mm, 1e-9);
}

TEST(Camera, PointsThatHaveNoPictureGiveNone) {
    const View view = make_view(CameraParams{}, 1.0);
    EXPECT_FALSE(project_to_uv(view, {0, -700, 0})) << "behind";
    EXPECT_FALSE(project_to_uv(view, {0, -600, 0})) << "in the eye";
    EXPECT_FALSE(project_to_uv(view, {5, -600, 0})) << "beside the eye";
    EXPECT_FALSE(project_to_uv(view, {nan, 0, 0}));
    EXPECT_FALSE(project_to_uv(view, {0, std::numeric_limits<double>::infinity(), 0}));
    const auto outside = project_to_uv(view, {1000, 0, 0});
    ASSERT_TRUE(outside);
    EXPECT_GT(outside->x, 1.0);
}

struct BrokenCamera {
    const char* what;
    void (*spoil)(CameraParams&);
};

class CameraErrors : public testing::TestWithParam<BrokenCamera> {};

TEST_P(CameraErrors, AreTyped) {
    CameraParams camera;
    ASSERT_NO_THROW((void)make_view(camera, 1.0));
    GetParam().spoil(camera);
    try {
        (void)make_view(camera, 1.0);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::scene);
        EXPECT_EQ(error.where(), "camera");
        EXPECT_NE(std::string(error.what()).find(GetParam().what), std::string::npos) << error.what();
    }
}

const BrokenCamera broken_cameras[] = {
    {"same point", [](CameraParams& c) { c.eye_mm = c.target_mm; }},
    {"zero vector", [](CameraParams& c) { c.up = glm::dvec3(0.0); }},
    {"along the view",
     [](CameraParams& c) {
         c.up = {0, 3, 0};
     }},
    {"along the view",
     [](CameraParams& c) {
         c.up = {0, -1, 0};
     }},
    {"finite", [](CameraParams& c) { c.eye_mm.x = nan; }},
    {"near_mm", [](CameraParams& c) { c.near_mm = c.far_mm; }},
    {"near_mm", [](CameraParams& c) { c.near_mm = 0.0; }},
    {"near_mm", [](CameraParams& c) { c.near_mm = nan; }},
    {"vertical_fov_deg", [](CameraParams& c) { c.vertical_fov_deg = 180.0; }},
    {"vertical_fov_deg", [](CameraParams& c) { c.vertical_fov_deg = nan; }},
    {"orbit", [](CameraParams& c) { c.orbit_deg_per_s = nan; }},
    {"height_mm",
     [](CameraParams& c) {
         c.kind = CameraKind::orthographic;
         c.height_mm = -1.0;
     }},
    {"source_image_distance_mm",
     [](CameraParams& c) {
         c.kind = CameraKind::c_arm;
         c.source_image_distance_mm = c.source_axis_distance_mm;
     }},
    {"source_axis_distance_mm",
     [](CameraParams& c) {
         c.kind = CameraKind::c_arm;
         c.source_axis_distance_mm = 0.0;
     }},
    {"detector_height_mm",
     [](CameraParams& c) {
         c.kind = CameraKind::c_arm;
         c.detector_height_mm = nan;
     }},
    {"primary_deg",
     [](CameraParams& c) {
         c.kind = CameraKind::c_arm;
         c.primary_deg = nan;
     }},
};
INSTANTIATE_TEST_SUITE_P(Each, CameraErrors, testing::ValuesIn(broken_cameras));

TEST(Camera, BadAspectAndTimeAreErrors) {
    for (const double aspect : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW((void)make_view(CameraParams{}, aspect), Error);
    }
    EXPECT_THROW((void)make_view(CameraParams{}, 1.0, nan), Error);
}

TEST(Camera, KindsHaveTheirNames) {
    const auto names = choice_names(CameraKind::c_arm);
    EXPECT_EQ(names[static_cast<std::size_t>(CameraKind::perspective)], "perspective");
    EXPECT_EQ(names[static_cast<std::size_t>(CameraKind::orthographic)], "orthographic");
    EXPECT_EQ(names[static_cast<std::size_t>(CameraKind::c_arm)], "c_arm");
}

}  // namespace
}  // namespace viscera

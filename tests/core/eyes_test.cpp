#include "engine/core/eyes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/core/error.h"

namespace viscera {
namespace {

CameraParams stereo_camera(CameraKind kind = CameraKind::perspective) {
    CameraParams camera;
    camera.kind = kind;
    camera.eye_mm = {40.0, -600.0, 25.0};
    camera.target_mm = {-10.0, 20.0, 5.0};
    camera.primary_deg = 20.0;
    camera.secondary_deg = 10.0;
    camera.stereo = StereoParams{.interpupillary_mm = 64.0, .convergence_mm = 450.0};
    return camera;
}

/// A point by its place before the middle eye: right, up, along the view [mm].
glm::dvec3 place(const View& middle, double right, double up, double along) {
    return glm::inverse(middle.view) * glm::dvec4(right, up, -along, 1.0);
}

class EveryKind : public testing::TestWithParam<CameraKind> {};

TEST_P(EveryKind, ThePlaneOfZeroParallaxIsSeenInTheSamePlace) {
    const CameraParams camera = stereo_camera(GetParam());
    const Eyes eyes = make_eyes(camera, 1.5);
    ASSERT_EQ(eyes.count, 2);
    const View middle = make_view(camera, 1.5);
    for (const double right : {-70.0, 0.0, 33.0}) {
        for (const double up : {-40.0, 0.0, 55.0}) {
            const glm::dvec3 point = place(middle, right, up, 450.0);
            const glm::dvec2 uv = *project_to_uv(middle, point);
            for (const View& eye : eyes.views) {
                const glm::dvec2 own = *project_to_uv(eye, point);
                EXPECT_NEAR(own.x, uv.x, 1e-12);
                EXPECT_NEAR(own.y, uv.y, 1e-12);
            }
        }
    }
}

TEST_P(EveryKind, ParallaxIsAsTheFormulaSaysAndNeverVertical) {
    const CameraParams camera = stereo_camera(GetParam());
    const Eyes eyes = make_eyes(camera, 1.5);
    const View middle = make_view(camera, 1.5);
    for (const double z : {100.0, 300.0, 450.0, 700.0, 5000.0}) {
        const glm::dvec3 point = place(middle, 12.0, -30.0, z);
        const glm::dvec2 left = *project_to_uv(eyes.views[0], point);
        const glm::dvec2 right = *project_to_uv(eyes.views[1], point);
        const double part = middle.orthographic ? 1.0 - z / 450.0 : 1.0 / z - 1.0 / 450.0;
        const double parallax = 64.0 * 0.5 * middle.projection[0][0] * part;
        EXPECT_NEAR(left.x - right.x, parallax, 1e-12) << "at " << z << " mm";
        EXPECT_NEAR(left.y, right.y, 1e-12) << "at " << z << " mm";
    }
}

TEST_P(EveryKind, AxesAreParallelAndEyesApart) {
    const CameraParams camera = stereo_camera(GetParam());
    const Eyes eyes = make_eyes(camera, 1.5);
    const View middle = make_view(camera, 1.5);
    for (int column = 0; column < 3; ++column) {
        EXPECT_EQ(eyes.views[0].view[column], eyes.views[1].view[column]) << "only moved, not turned";
    }
    EXPECT_NEAR(glm::distance(eyes.views[0].eye_mm, eyes.views[1].eye_mm), 64.0, 1e-9);
    EXPECT_NEAR(glm::length(0.5 * (eyes.views[0].eye_mm + eyes.views[1].eye_mm) - middle.eye_mm), 0.0, 1e-9);
    for (const View& eye : eyes.views) {
        EXPECT_NEAR(glm::length(glm::dvec3(eye.view * glm::dvec4(eye.eye_mm, 1.0))), 0.0, 1e-9);
        EXPECT_EQ(eye.mirrored, middle.mirrored);
    }
}

TEST_P(EveryKind, EyesInOnePlaceAreTheOneEye) {
    CameraParams camera = stereo_camera(GetParam());
    camera.stereo->interpupillary_mm = 0.0;
    const Eyes eyes = make_eyes(camera, 0.7, 2.0);
    const View middle = make_view(camera, 0.7, 2.0);
    for (const View& eye : eyes.views) {
        EXPECT_EQ(eye.view, middle.view);
        EXPECT_EQ(eye.projection, middle.projection);
        EXPECT_EQ(eye.eye_mm, middle.eye_mm);
    }
}

INSTANTIATE_TEST_SUITE_P(Eyes, EveryKind,
                         testing::Values(CameraKind::perspective, CameraKind::orthographic,
                                         CameraKind::c_arm));

TEST(Eyes, OrthographicRaysMeetAtTheConvergence) {
    const CameraParams camera = stereo_camera(CameraKind::orthographic);
    const Eyes eyes = make_eyes(camera, 1.0);
    const View middle = make_view(camera, 1.0);
    for (const View& eye : eyes.views) {
        // The ray through the eye runs to the picture's centre on the plane of zero parallax.
        const glm::dvec3 met = eye.eye_mm + eye.forward * (450.0 / glm::dot(eye.forward, middle.forward));
        EXPECT_NEAR(glm::length(met - (middle.eye_mm + 450.0 * middle.forward)), 0.0, 1e-9);
        const glm::dvec2 far = *project_to_uv(eye, eye.eye_mm + 900.0 * eye.forward);
        EXPECT_NEAR(far.x, project_to_uv(eye, met)->x, 1e-12) << "along a ray nothing moves in the picture";
    }
}

TEST(Eyes, ConvergeByDefaultWhereTheCameraLooks) {
    for (const CameraKind kind : {CameraKind::perspective, CameraKind::orthographic, CameraKind::c_arm}) {
        CameraParams camera = stereo_camera(kind);
        camera.stereo->convergence_mm.reset();
        const glm::dvec3 at = kind == CameraKind::c_arm ? camera.isocentre_mm : camera.target_mm;
        for (const View& eye : make_eyes(camera, 1.0).views) {
            EXPECT_NEAR(project_to_uv(eye, at)->x, 0.5, 1e-12);
        }
    }
}

TEST(Eyes, WithoutStereoThereIsOne) {
    CameraParams camera = stereo_camera();
    camera.stereo.reset();
    const Eyes eyes = make_eyes(camera, 1.0);
    EXPECT_EQ(eyes.count, 1);
    EXPECT_EQ(eyes.views[0].projection, make_view(camera, 1.0).projection);
}

TEST(Eyes, BadDistancesAreRefused) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double bad : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
        CameraParams camera = stereo_camera();
        camera.stereo->interpupillary_mm = bad;
        EXPECT_THROW((void)make_eyes(camera, 1.0), Error) << bad;
    }
    for (const double bad : {0.0, -5.0, nan, std::numeric_limits<double>::infinity()}) {
        CameraParams camera = stereo_camera();
        camera.stereo->convergence_mm = bad;
        EXPECT_THROW((void)make_eyes(camera, 1.0), Error) << bad;
    }
}

TEST(Eyes, NamesSayWhichEye) {
    EXPECT_EQ(eye_name("volume.colour", 0), "volume.colour.left");
    EXPECT_EQ(eye_name("volume.colour", 1), "volume.colour.right");
}

}  // namespace
}  // namespace viscera

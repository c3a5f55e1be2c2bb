#include "samples/viscera/camera_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

namespace viscera::app {
namespace {

constexpr double degrees_per_height = 180.0;

struct CameraAxes {
    glm::dvec3 forward;
    glm::dvec3 right;
    glm::dvec3 up;
};

CameraAxes camera_axes(const CameraParams& camera) {
    const glm::dvec3 forward = glm::normalize(camera.target_mm - camera.eye_mm);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, camera.up));
    return {forward, right, glm::cross(right, forward)};
}

/// Height that the picture covers where it looks at [mm].
double visible_height(const CameraParams& camera) {
    switch (camera.kind) {
        case CameraKind::c_arm:
            return camera.detector_height_mm * camera.source_axis_distance_mm /
                   camera.source_image_distance_mm;
        case CameraKind::orthographic:
            return camera.height_mm;
        case CameraKind::perspective:
            return 2.0 * glm::distance(camera.eye_mm, camera.target_mm) *
                   std::tan(camera.vertical_fov_deg * std::numbers::pi / 360.0);
    }
    return 1.0;
}

}  // namespace

void rotate(CameraParams& camera, double x, double y) {
    if (camera.kind == CameraKind::c_arm) {
        camera.primary_deg = std::remainder(camera.primary_deg - x * degrees_per_height, 360.0);
        camera.secondary_deg = std::clamp(camera.secondary_deg - y * degrees_per_height, -89.0, 89.0);
        return;
    }
    const CameraAxes axes = camera_axes(camera);
    const glm::dmat4 yaw = glm::rotate(glm::dmat4(1.0), glm::radians(-x * degrees_per_height), camera.up);
    const glm::dmat4 turn = glm::rotate(yaw, glm::radians(y * degrees_per_height), axes.right);
    const glm::dvec3 arm(turn * glm::dvec4(camera.eye_mm - camera.target_mm, 0.0));
    // Short of the poles, where up is along the view.
    if (std::abs(glm::dot(glm::normalize(arm), glm::normalize(camera.up))) < 0.999) {
        camera.eye_mm = camera.target_mm + arm;
    }
}

void pan(CameraParams& camera, double x, double y) {
    const double height = visible_height(camera);
    if (camera.kind == CameraKind::c_arm) {
        const View view = make_view(camera, 1.0);
        const glm::dmat4 to_world = glm::inverse(view.view);
        const double sideways = view.projection[0][0] < 0.0 ? -x : x;  // seen from the detector's side
        camera.isocentre_mm -= height * glm::dvec3(sideways * to_world[0] + y * to_world[1]);
        return;
    }
    const CameraAxes axes = camera_axes(camera);
    const glm::dvec3 move = height * (x * axes.right + y * axes.up);
    camera.eye_mm -= move;
    camera.target_mm -= move;
}

void zoom(CameraParams& camera, double factor) {
    switch (camera.kind) {
        case CameraKind::c_arm:
            camera.detector_height_mm = std::clamp(camera.detector_height_mm / factor, 1.0, 2000.0);
            break;
        case CameraKind::orthographic:
            camera.height_mm = std::clamp(camera.height_mm / factor, 1e-3, 1e6);
            break;
        case CameraKind::perspective:
            camera.eye_mm = camera.target_mm + (camera.eye_mm - camera.target_mm) / factor;
            break;
    }
}

void standard_view(CameraParams& camera, int digit) {
    if (camera.kind == CameraKind::c_arm) {
        camera.primary_deg = digit == 3 ? 90.0 : 0.0;
        camera.secondary_deg = digit == 7 ? 89.0 : 0.0;
        return;
    }
    const double distance = glm::distance(camera.eye_mm, camera.target_mm);
    const glm::dvec3 direction = digit == 3   ? glm::dvec3(1.0, 0.0, 0.0)
                                 : digit == 7 ? glm::dvec3(0.0, 0.0, 1.0)
                                              : glm::dvec3(0.0, -1.0, 0.0);
    camera.eye_mm = camera.target_mm + distance * direction;
    camera.up = digit == 7 ? glm::dvec3(0.0, -1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
}

}  // namespace viscera::app

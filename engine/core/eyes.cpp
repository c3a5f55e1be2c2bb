#include "engine/core/eyes.h"

#include <cmath>

#include "engine/core/error.h"

namespace viscera {

View shifted_view(const View& view, double offset_mm, double convergence_mm) {
    View eye = view;
    const glm::dvec3 right(view.view[0][0], view.view[1][0], view.view[2][0]);
    eye.view[3][0] -= offset_mm;
    eye.eye_mm += offset_mm * right;
    eye.camera_in_eye_mm.x -= offset_mm;
    // Clip x gains offset/convergence for each mm in front of the eye. For a perspective, where that is w, it
    // moves the picture; for an orthographic view it slants the rays.
    const double slope = offset_mm / convergence_mm;
    eye.projection[2][0] -= view.projection[0][0] * slope;
    if (view.orthographic) {
        const glm::dvec3 along(-slope, 0.0, -1.0);
        eye.forward = glm::normalize(glm::transpose(glm::dmat3(view.view)) * along);
    }
    return eye;
}

Eyes make_eyes(const CameraParams& camera, double aspect, double time_s) {
    Eyes eyes{.views = {make_view(camera, aspect, time_s)}};
    if (!camera.stereo) {
        return eyes;
    }
    const double to_target = camera.kind == CameraKind::c_arm
                                 ? camera.source_axis_distance_mm
                                 : glm::distance(camera.eye_mm, camera.target_mm);
    const double distance_mm = camera.stereo->interpupillary_mm;
    const double convergence_mm = camera.stereo->convergence_mm.value_or(to_target);
    if (!(std::isfinite(distance_mm) && distance_mm >= 0.0)) {
        throw Error(ErrorCode::scene, "camera", "stereo.interpupillary_mm must not be negative");
    }
    if (!(std::isfinite(convergence_mm) && convergence_mm > 0.0)) {
        throw Error(ErrorCode::scene, "camera", "stereo.convergence_mm must be positive");
    }
    const View middle = eyes.views[0];
    eyes.count = 2;
    eyes.views = {shifted_view(middle, -0.5 * distance_mm, convergence_mm),
                  shifted_view(middle, 0.5 * distance_mm, convergence_mm)};
    return eyes;
}

std::string_view eye_word(int eye) {
    return eye == 0 ? "left" : "right";
}

std::string eye_name(std::string_view name, int eye) {
    return std::string(name) + "." + std::string(eye_word(eye));
}

}  // namespace viscera

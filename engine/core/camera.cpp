#include "engine/core/camera.h"

#include <algorithm>
#include <cmath>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

#include "engine/core/error.h"
#include "engine/core/finite.h"

namespace viscera {
namespace {

constexpr std::array<std::string_view, 3> kind_names{"perspective", "orthographic", "c_arm"};
constexpr std::array<std::string_view, 2> layout_names{"separate", "side_by_side"};

// Sine of the smallest angle between `up` and the view at which the picture still stands firmly.
constexpr double min_sine = 1e-9;

void require(bool holds, const char* message) {
    if (!holds) {
        throw Error(ErrorCode::scene, "camera", message);
    }
}

/// A camera that looks at a point, whatever kind it came from.
struct Pose {
    glm::dvec3 eye_mm{0.0};
    glm::dvec3 target_mm{0.0};
    glm::dvec3 up{0.0};
};

Pose orbiting_pose(const CameraParams& camera, double angle_rad) {
    require(finite(camera.eye_mm) && finite(camera.target_mm) && finite(camera.up),
            "eye_mm, target_mm and up must be finite");
    const double up_length = glm::length(camera.up);
    require(up_length > 0.0 && finite(up_length), "up must not be the zero vector");
    const glm::dvec3 axis = camera.up / up_length;
    const glm::dvec3 arm = camera.eye_mm - camera.target_mm;
    const double distance = glm::length(arm);
    require(distance > 0.0 && finite(distance), "eye_mm and target_mm are the same point");
    require(glm::length(glm::cross(axis, arm / distance)) > min_sine, "up lies along the view");
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle_rad, axis);
    return {camera.target_mm + glm::dmat3(turn) * arm, camera.target_mm, axis};
}

Pose c_arm_pose(const CameraParams& camera, double angle_rad) {
    require(finite(camera.isocentre_mm), "isocentre_mm must be finite");
    require(finite(camera.primary_deg) && finite(camera.secondary_deg),
            "primary_deg and secondary_deg must be finite");
    const double a = glm::radians(camera.primary_deg) + angle_rad;
    const double b = glm::radians(camera.secondary_deg);
    // From the isocentre to the detector in LPS; `up` is how that direction moves as the secondary angle
    // grows, which points to the head at 0 and stays defined at 90 degrees.
    const glm::dvec3 to_detector(std::sin(a) * std::cos(b), -std::cos(a) * std::cos(b), std::sin(b));
    const glm::dvec3 up(-std::sin(a) * std::sin(b), std::cos(a) * std::sin(b), std::cos(b));
    return {camera.isocentre_mm - camera.source_axis_distance_mm * to_detector, camera.isocentre_mm, up};
}

void check_ranges(const CameraParams& camera, double aspect, double time_s) {
    require(finite(aspect) && aspect > 0.0, "the aspect ratio must be positive");
    require(finite(time_s) && finite(camera.orbit_deg_per_s), "time and orbit_deg_per_s must be finite");
    require(finite(camera.near_mm) && finite(camera.far_mm) && camera.near_mm > 0.0,
            "near_mm must be positive and far_mm finite");
    require(camera.near_mm < camera.far_mm, "near_mm must be less than far_mm");
    switch (camera.kind) {
        case CameraKind::perspective:
            require(camera.vertical_fov_deg > 0.0 && camera.vertical_fov_deg < 180.0,
                    "vertical_fov_deg must lie between 0 and 180");
            return;
        case CameraKind::orthographic:
            require(finite(camera.height_mm) && camera.height_mm > 0.0, "height_mm must be positive");
            return;
        case CameraKind::c_arm:
            require(camera.source_axis_distance_mm > 0.0, "source_axis_distance_mm must be positive");
            require(finite(camera.source_image_distance_mm) &&
                        camera.source_image_distance_mm > camera.source_axis_distance_mm,
                    "source_image_distance_mm must be more than source_axis_distance_mm");
            require(finite(camera.detector_height_mm) && camera.detector_height_mm > 0.0,
                    "detector_height_mm must be positive");
            return;
    }
    require(false, "unknown kind");
}

glm::dmat4 projection_of(const CameraParams& camera, double aspect) {
    const double near = camera.near_mm;
    const double far = camera.far_mm;
    if (camera.kind == CameraKind::orthographic) {
        const double half_height = 0.5 * camera.height_mm;
        const double half_width = half_height * aspect;
        return glm::orthoRH_NO(-half_width, half_width, -half_height, half_height, near, far);
    }
    if (camera.kind == CameraKind::perspective) {
        return glm::perspectiveRH_NO(glm::radians(camera.vertical_fov_deg), aspect, near, far);
    }
    // The detector, seen from the source, brought to the near plane. Left and right change places because
    // the picture is looked at from behind the detector.
    const double half_height = 0.5 * camera.detector_height_mm * near / camera.source_image_distance_mm;
    const double half_width = half_height * aspect;
    return glm::frustumRH_NO(half_width, -half_width, -half_height, half_height, near, far);
}

}  // namespace

std::span<const std::string_view> choice_names(CameraKind) {
    return kind_names;
}

std::span<const std::string_view> choice_names(StereoLayout) {
    return layout_names;
}

void StereoParams::visit(ParamVisitor& v) {
    v.field({.name = "interpupillary_mm", .doc = "Distance of the eyes.", .unit = "mm", .min = 0.0},
            interpupillary_mm);
    v.field({.name = "convergence_mm",
             .doc = "Distance, along the view, of the plane that both eyes see in the same place (zero "
                    "parallax); by default that of target_mm or of the isocentre.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            convergence_mm);
    v.field({.name = "layout",
             .doc = "separate: outputs NAME.left and NAME.right; side_by_side: one output NAME of twice the "
                    "width."},
            layout);
}

void CameraParams::visit(ParamVisitor& v) {
    v.field({.name = "kind", .doc = "How the camera projects, and which of the other keys it heeds."}, kind);
    v.field({.name = "eye_mm", .doc = "Eye (perspective, orthographic).", .unit = "mm"}, eye_mm);
    v.field({.name = "target_mm",
             .doc = "Point in the centre of the picture (perspective, orthographic).",
             .unit = "mm"},
            target_mm);
    v.field({.name = "up", .doc = "Direction that is up in the picture (perspective, orthographic)."}, up);
    v.field({.name = "vertical_fov_deg",
             .doc = "Vertical field of view (perspective).",
             .unit = "degree",
             .min = 0.1,
             .max = 179.0},
            vertical_fov_deg);
    v.field({.name = "height_mm",
             .doc = "Height of what is seen (orthographic).",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            height_mm);
    v.field({.name = "isocentre_mm", .doc = "Point about which the C-arm turns (c_arm).", .unit = "mm"},
            isocentre_mm);
    v.field({.name = "source_axis_distance_mm",
             .doc = "From the X-ray source to the isocentre, SAD (c_arm).",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            source_axis_distance_mm);
    v.field({.name = "source_image_distance_mm",
             .doc = "From the X-ray source to the detector, SID, more than SAD (c_arm).",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            source_image_distance_mm);
    v.field({.name = "detector_height_mm",
             .doc = "Height of the detector; its width follows from the picture's (c_arm).",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            detector_height_mm);
    v.field({.name = "primary_deg",
             .doc = "Positioner primary angle, LAO positive, RAO negative (c_arm).",
             .unit = "degree",
             .min = -180.0,
             .max = 180.0},
            primary_deg);
    v.field({.name = "secondary_deg",
             .doc = "Positioner secondary angle, cranial positive, caudal negative (c_arm).",
             .unit = "degree",
             .min = -90.0,
             .max = 90.0},
            secondary_deg);
    v.field({.name = "near_mm",
             .doc = "Distance of the near plane.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            near_mm);
    v.field({.name = "far_mm",
             .doc = "Distance of the far plane, more than near_mm.",
             .unit = "mm",
             .min = 0.0,
             .min_excluded = true},
            far_mm);
    v.field({.name = "orbit_deg_per_s",
             .doc = "Turns the camera about `up` through the target, or the C-arm's primary angle, in time.",
             .unit = "degree/s"},
            orbit_deg_per_s);
    v.field({.name = "stereo", .doc = "Two eyes, left and right of the camera's, with parallel axes."},
            stereo);
}

glm::dvec3 View::direction_to(const glm::dvec3& point_mm) const {
    const glm::dvec3 ray = point_mm - eye_mm;
    const double length = glm::length(ray);
    return orthographic || !(length > 0.0) ? forward : ray / length;
}

View view_of(const glm::dmat4& view, const glm::dmat4& projection) {
    const glm::dmat3 turn(view);
    const double size = glm::determinant(turn);
    // Of what is seen of x and y, as a share of itself: squares of the smallest scales vanish.
    const double scale =
        std::max(glm::length(glm::dvec2(projection[0])), glm::length(glm::dvec2(projection[1])));
    const glm::dmat2 flat(glm::dvec2(projection[0]) / scale, glm::dvec2(projection[1]) / scale);
    const double area = glm::determinant(flat);
    if (!finite(view) || !finite(projection) || std::abs(std::abs(size) - 1.0) > 1e-3 ||
        !(std::abs(area) > 0.0)) {
        throw Error(ErrorCode::usage, "a view",
                    "needs a rigid view matrix and a projection of some height and width, all finite");
    }
    View made{.view = view, .projection = projection};
    made.orthographic = projection[2][3] == 0.0;
    made.mirrored = area * size < 0.0;
    made.eye_mm = -(glm::transpose(turn) * glm::dvec3(view[3]));
    // Rays of a parallel projection may slant: along them neither x nor y of the picture changes.
    glm::dvec3 along(0.0, 0.0, -1.0);
    if (made.orthographic) {
        const glm::dvec2 shear = glm::inverse(flat) * (glm::dvec2(projection[2]) / scale);
        along = {shear.x, shear.y, -1.0};
    }
    made.forward = glm::normalize(glm::transpose(turn) * along);
    return made;
}

View make_view(const CameraParams& camera, double aspect, double time_s) {
    check_ranges(camera, aspect, time_s);
    const double angle_rad = glm::radians(camera.orbit_deg_per_s * time_s);
    require(finite(angle_rad), "the orbit's angle is beyond all bounds");
    const bool c_arm = camera.kind == CameraKind::c_arm;
    const Pose pose = c_arm ? c_arm_pose(camera, angle_rad) : orbiting_pose(camera, angle_rad);

    View view = view_of(glm::lookAtRH(pose.eye_mm, pose.target_mm, pose.up), projection_of(camera, aspect));
    // As given, to the bit.
    view.eye_mm = pose.eye_mm;
    view.forward = glm::normalize(pose.target_mm - pose.eye_mm);
    return view;
}

std::optional<glm::dvec2> project_to_uv(const View& view, const glm::dvec3& point_mm) {
    if (!finite(point_mm) || !(glm::dot(point_mm - view.eye_mm, view.forward) > 0.0)) {
        return std::nullopt;
    }
    const glm::dvec4 clip = view.view_projection() * glm::dvec4(point_mm, 1.0);
    const glm::dvec2 uv = 0.5 * glm::dvec2(clip) / clip.w + 0.5;
    if (!(clip.w > 0.0) || !finite(uv)) {
        return std::nullopt;
    }
    return uv;
}

}  // namespace viscera

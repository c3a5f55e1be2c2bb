#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "engine/core/params.h"

namespace viscera {

enum class CameraKind { perspective, orthographic, c_arm };
[[nodiscard]] std::span<const std::string_view> choice_names(CameraKind kind);

/// How a scene's outputs are handed over when a frame has two eyes: one target per eye, `NAME.left` and
/// `NAME.right`, or besides these one picture `NAME` of twice the width.
enum class StereoLayout { separate, side_by_side };
[[nodiscard]] std::span<const std::string_view> choice_names(StereoLayout layout);

/// Two eyes in place of one: see engine/core/eyes.h.
struct StereoParams {
    double interpupillary_mm = 63.0;
    std::optional<double> convergence_mm;  ///< none: the distance of the camera's target or isocentre
    StereoLayout layout = StereoLayout::separate;

    void visit(ParamVisitor& v);
};

/// Camera of a scene. World frame: LPS patient axes, millimetres (x to the patient's left, y to the back, z
/// to the head).
struct CameraParams {
    CameraKind kind = CameraKind::perspective;
    // perspective, orthographic
    glm::dvec3 eye_mm{0.0, -600.0, 0.0};
    glm::dvec3 target_mm{0.0};
    glm::dvec3 up{0.0, 0.0, 1.0};
    double vertical_fov_deg = 30.0;
    double height_mm = 200.0;
    // c_arm: eye in the X-ray source. At angles 0/0 the source is behind the patient and the detector in
    // front (y towards -y); at primary +90 the detector is at the patient's left. Up is the head. The picture
    // is looked at from behind the detector, as on the screen in the cath lab: at 0/0 the patient's left is
    // on the right. At the isocentre detector_height_mm * SAD / SID is seen.
    glm::dvec3 isocentre_mm{0.0};
    double source_axis_distance_mm = 750.0;    ///< SAD
    double source_image_distance_mm = 1200.0;  ///< SID
    double detector_height_mm = 300.0;
    double primary_deg = 0.0;    ///< positioner primary angle: LAO positive (DICOM 0018,1510)
    double secondary_deg = 0.0;  ///< positioner secondary angle: cranial positive (DICOM 0018,1511)
    // all
    double near_mm = 1.0;
    double far_mm = 10000.0;
    double orbit_deg_per_s =
        0.0;  ///< turns the camera about `up` through the target (c_arm: primary angle) as time passes

    std::optional<StereoParams> stereo;

    void visit(ParamVisitor& v);
};

/// Matrices of one eye, double precision. Clip space as OpenGL has it (z in [-w, w]).
struct View {
    glm::dmat4 view{1.0};                ///< world [mm] to eye
    glm::dmat4 projection{1.0};          ///< eye to clip
    glm::dvec3 eye_mm{0.0};              ///< for orthographic: a point on the eye plane
    glm::dvec3 forward{0.0, 0.0, -1.0};  ///< unit; orthographic: along the rays
    bool orthographic = false;
    bool mirrored =
        false;  ///< one axis of the picture is turned round, so front faces turn clockwise (c_arm)
    glm::dvec3 camera_in_eye_mm{0.0};  ///< what lights at the camera count from; not 0 for an eye of two

    [[nodiscard]] glm::dmat4 view_projection() const { return projection * view; }
    /// Unit direction from the eye through a world point (orthographic: forward).
    [[nodiscard]] glm::dvec3 direction_to(const glm::dvec3& point_mm) const;
};

/// View of a host's own matrices; what else a View says follows from them. view: a rigid motion, the eye
/// looking along its -z; projection: perspective or parallel, along either axis of the picture turned round
/// if need be. Throws Error(usage) where they are not finite, or no picture could be made by them.
[[nodiscard]] View view_of(const glm::dmat4& view, const glm::dmat4& projection);

/// View at a time, of an eye between the two when there are two. aspect = width / height > 0. Throws
/// Error(scene) where the camera is degenerate: eye on target, up along the view, near >= far, SID <= SAD.
[[nodiscard]] View make_view(const CameraParams& camera, double aspect, double time_s = 0.0);

/// Target UV (origin bottom-left) of a world point; none when the point is behind the eye or not finite.
[[nodiscard]] std::optional<glm::dvec2> project_to_uv(const View& view, const glm::dvec3& point_mm);

}  // namespace viscera

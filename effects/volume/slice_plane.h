#pragma once

#include <optional>
#include <span>
#include <string_view>

#include <glm/glm.hpp>

#include "engine/core/mesh_data.h"
#include "engine/core/params.h"

namespace viscera::volume {

/// Along which axis of the patient a slice is looked at.
enum class SliceAxis { axial, coronal, sagittal };
[[nodiscard]] std::span<const std::string_view> choice_names(SliceAxis axis);

/// A plane of any direction.
struct ObliqueParams {
    glm::dvec3 point_mm{0.0};
    glm::dvec3 normal{0.0, 0.0, -1.0};
    glm::dvec3 up{0.0, -1.0, 0.0};

    void visit(ParamVisitor& v);
};

/// Where a volume is cut.
struct PlaneParams {
    SliceAxis axis = SliceAxis::axial;
    std::optional<double> position_mm;
    std::optional<ObliqueParams> oblique;

    void visit(ParamVisitor& v);
    /// Throws Error(scene): normal of length 0, or up along it.
    void validate() const;
};

/// A plane with the picture's directions on it, all of length 1 and at right angles: right x up points to the
/// eye.
struct SlicePlane {
    glm::dvec3 centre_mm{0.0};  ///< in the picture's middle
    glm::dvec3 right{1.0, 0.0, 0.0};
    glm::dvec3 up{0.0, 1.0, 0.0};

    [[nodiscard]] glm::dvec3 normal() const { return glm::cross(right, up); }
};

/// As radiologists look at them: axial from the feet, front up; coronal from the front, head up; sagittal
/// from the left, head up and front on the left. `texture_to_world`: of the volume, whose centre the picture
/// shows unless an oblique plane has a point of its own.
[[nodiscard]] SlicePlane slice_plane(const PlaneParams& params, const glm::dmat4& texture_to_world);

/// Height of the picture [mm] about the plane's centre in which all of the volume can be seen. aspect:
/// width / height.
[[nodiscard]] double fitting_height_mm(const SlicePlane& plane, const glm::dmat4& texture_to_world,
                                       double aspect);

/// What a plane cuts out of the box [0, 1]^3, in local coordinates, as triangles about one corner; none where
/// it misses the box.
[[nodiscard]] MeshData cut_polygon(const SlicePlane& plane, const glm::dmat4& texture_to_world);

}  // namespace viscera::volume

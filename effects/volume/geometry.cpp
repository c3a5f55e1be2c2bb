#include "effects/volume/geometry.h"

#include <algorithm>
#include <string>

#include "engine/core/error.h"

namespace viscera::volume {

void GeometryParams::visit(ParamVisitor& v) {
    v.field(
        {.name = "kind",
         .doc = "What the axes (i, j, k) run along: cartesian x, y, z; cylindrical radius, angle, height; "
                "spherical longitude, latitude, radius.",
         .required = true},
        kind);
    v.field({.name = "r_min_mm", .doc = "Radius of the first sample.", .unit = "mm", .min = 0.0}, r_min_mm);
    v.field({.name = "r_max_mm",
             .doc = "Radius of the last sample; 0: r_min_mm and the file's spacing for each interval.",
             .unit = "mm",
             .min = 0.0},
            r_max_mm);
    v.field({.name = "first_angle_deg",
             .doc = "Angle or longitude of the first sample, from the frame's x towards its y.",
             .unit = "degree",
             .min = -360.0,
             .max = 360.0},
            first_angle_deg);
    v.field({.name = "angle_deg",
             .doc = "Angle or longitude from the first sample to the last; with wrap to the first again.",
             .unit = "degree",
             .min = 0.0,
             .max = 360.0},
            angle_deg);
    v.field(
        {.name = "wrap",
         .doc = "The last sample is a neighbour of the first, one interval before it: needs 360 degrees."},
        wrap);
    v.field(
        {.name = "height_mm",
         .doc = "Cylindrical: from the first sample to the last; 0: the file's spacing for each interval.",
         .unit = "mm",
         .min = 0.0},
        height_mm);
    v.field({.name = "latitude_deg",
             .doc = "Spherical: from the first sample to the last, half of it to either side of the equator.",
             .unit = "degree",
             .min = 0.0,
             .max = 180.0},
            latitude_deg);
}

void GeometryParams::validate(std::string_view where) const {
    const std::string at(where);
    if (kind == VolumeKind::cartesian) {
        return;
    }
    if (r_max_mm != 0.0 && r_max_mm < r_min_mm) {
        throw Error(ErrorCode::scene, at + "/r_max_mm", "is less than r_min_mm");
    }
    if (wrap && angle_deg != 360.0) {
        throw Error(ErrorCode::scene, at + "/wrap", "needs an angle_deg of 360");
    }
}

VolumeGrid GeometryParams::applied_to(VolumeGrid grid) const {
    grid.shape = {};
    if (kind == VolumeKind::cartesian) {
        return grid;
    }
    VolumeShape& shape = grid.shape;
    shape.kind = kind;
    const auto by_spacing = [&](int axis) {
        return grid.spacing_mm[axis] * static_cast<double>(std::max(grid.dims[axis] - 1, 1));
    };
    shape.r_min_mm = r_min_mm;
    shape.r_max_mm = r_max_mm > 0.0 ? r_max_mm : r_min_mm + by_spacing(shape.radius_axis());
    shape.first_angle_rad = glm::radians(first_angle_deg);
    shape.angle_rad = glm::radians(angle_deg);
    shape.wrap = wrap;
    if (kind == VolumeKind::cylindrical) {
        shape.height_mm = height_mm > 0.0 ? height_mm : by_spacing(2);
    } else {
        shape.latitude_rad = glm::radians(latitude_deg);
    }
    return grid;
}

}  // namespace viscera::volume

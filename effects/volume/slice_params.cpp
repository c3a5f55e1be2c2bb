#include "effects/volume/slice_params.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/error.h"

namespace viscera::volume {

std::span<const std::string_view> choice_names(SliceView) {
    static constexpr std::array<std::string_view, 2> names{"picture", "camera"};
    return names;
}

std::span<const std::string_view> choice_names(SlabFunction) {
    static constexpr std::array<std::string_view, 3> names{"mean", "mip", "minip"};
    return names;
}

void SlabParams::visit(ParamVisitor& v) {
    v.field({.name = "thickness_mm", .doc = "About the plane; 0: a thin slice.", .unit = "mm", .min = 0.0},
            thickness_mm);
    v.field({.name = "function", .doc = "Mean, greatest or least value across the slab."}, function);
    v.field({.name = "step",
             .doc = "Between samples across the slab.",
             .unit = "voxel",
             .min = 0.0,
             .min_excluded = true},
            step);
}

void SliceParams::visit(ParamVisitor& v) {
    v.field({.name = "volume", .doc = "The volume.", .required = true}, volume);
    v.field(
        {.name = "view",
         .doc = "picture: the plane fills the picture; camera: as the scene's camera sees it, with depth."},
        view);
    v.field({.name = "plane", .doc = "Where the volume is cut."}, plane);
    mesh.visit(
        v, "mesh",
        "Surface that cuts the volume instead of the plane (camera): glTF, GLB, STL, OBJ, PLY or VTP.");
    v.field({.name = "height_mm",
             .doc = "Height of the picture, whose pixels are square; 0: all of the volume (picture).",
             .unit = "mm",
             .min = 0.0},
            height_mm);
    v.field({.name = "slab", .doc = "Thickness of the slice."}, slab);
    v.field({.name = "transfer_function",
             .doc = "Colour over value, without opacity; by default grey from the least value to the "
                    "greatest. Always interpolated."},
            transfer_function);
    v.field({.name = "sampling", .doc = "How the volume is reconstructed between its voxels."}, sampling);
    v.field({.name = "background",
             .doc = "Red, green, blue and opacity beside the volume (picture).",
             .min = 0.0,
             .max = 65504.0},
            background);
}

void SliceParams::validate() const {
    volume.validate();
    transfer_function.validate();
    plane.validate();
    if (background.a > 1.0) {
        throw Error(ErrorCode::scene, "/background", "has an opacity above 1");
    }
    if (mesh.empty()) {
        return;
    }
    if (view == SliceView::picture) {
        throw Error(ErrorCode::scene, "/mesh", "only the camera's view shows meshes");
    }
    if (slab.thickness_mm > 0.0) {
        throw Error(ErrorCode::scene, "/slab/thickness_mm", "only planes have a thickness");
    }
}

int slab_samples(const SlabParams& slab, const glm::dvec3& voxels_per_mm) {
    const glm::dvec3 crossed = glm::abs(voxels_per_mm) * slab.thickness_mm;
    const double count = std::ceil(std::max({crossed.x, crossed.y, crossed.z}) / slab.step);
    return static_cast<int>(std::clamp(count, 1.0, static_cast<double>(most_slab_samples)));
}

}  // namespace viscera::volume

#include "effects/volume/ray_cast_params.h"

#include <array>

#include "engine/core/error.h"

namespace viscera::volume {
namespace {

constexpr std::array<std::string_view, 8> function_names{"composite", "mip",        "minip",      "average",
                                                         "xray",      "isosurface", "accumulate", "density"};

}  // namespace

std::span<const std::string_view> choice_names(RayFunction) {
    return function_names;
}

RayFunction marched_as(RayFunction function) {
    return function == RayFunction::accumulate || function == RayFunction::density ? RayFunction::composite
                                                                                   : function;
}

void CropParams::visit(ParamVisitor& v) {
    v.field({.name = "first", .doc = "First voxel that is shown.", .unit = "voxel", .min = 0.0}, first);
    v.field({.name = "size", .doc = "Voxels that are shown; 0: all to the end.", .unit = "voxel", .min = 0.0},
            size);
}

void FilmParams::visit(ParamVisitor& v) {
    v.field({.name = "from", .doc = "Line integral of attenuation up to which nothing counts as absorbed."},
            from);
    v.field({.name = "to", .doc = "Line integral from which on all counts as absorbed."}, to);
}

void XrayParams::visit(ParamVisitor& v) {
    v.field({.name = "water_attenuation_per_mm",
             .doc = "Attenuation of water; that of a voxel is this times 1 + HU / 1000, never below 0.",
             .unit = "1/mm",
             .min = 0.0},
            water_attenuation_per_mm);
    v.field({.name = "incident", .doc = "Intensity in front of the volume.", .min = 0.0, .max = 65504.0},
            incident);
    v.field({.name = "negative", .doc = "Shows what is absorbed as bright, as films do."}, negative);
    v.field(
        {.name = "film",
         .doc = "Brightness goes by the line integral itself, over a range, as films and digital detectors "
                "show it; without it by the intensity, which is next to nothing behind a head."},
        film);
}

void XrayParams::validate() const {
    if (film && !(film->from < film->to)) {
        throw Error(ErrorCode::scene, "/xray/film", "'from' must be less than 'to'");
    }
}

void SubVolumeParams::visit(ParamVisitor& v) {
    v.field({.name = "depth_mm", .doc = "Length of each ray.", .unit = "mm", .min = 0.0}, depth_mm);
}

void RayCastParams::visit(ParamVisitor& v) {
    v.field({.name = "volume", .doc = "The volume.", .required = true}, volume);
    v.field({.name = "function",
             .doc = "What is made of the values along a ray; by default what the transfer function's file "
                    "asks for, else composite."},
            function);
    v.field({.name = "transfer_function", .doc = "Colour and opacity over value."}, transfer_function);
    v.field({.name = "sampling", .doc = "Where rays are sampled: time against error."}, sampling);
    v.field({.name = "mixed",
             .doc = "One of the two passes of a picture in mixed resolution; without it every pixel's ray is "
                    "cast."},
            mixed);
    v.field({.name = "crop", .doc = "Part of the volume that is shown."}, crop);
    v.field({.name = "sub_volume",
             .doc = "Only a given depth behind where rays start: a drawn surface (sampling.limits), a clip "
                    "plane or the box."},
            sub_volume);
    v.field({.name = "xray", .doc = "Attenuation and film (xray)."}, xray);
    v.field({.name = "threshold", .doc = "Values below it are dropped (mip, minip, average)."}, threshold);
    v.field({.name = "isosurface", .doc = "Surfaces of constant value (isosurface)."}, isosurface);
    v.field({.name = "accumulate", .doc = "Opacity and brightness by value (accumulate)."}, accumulate);
    v.field({.name = "density", .doc = "One density for all that is seen (density)."}, density);
    look.visit(v);
}

}  // namespace viscera::volume

#include "effects/contrast/geometry_params.h"

#include <array>

namespace viscera::contrast {
namespace {

constexpr std::array<std::string_view, 4> method_names{"max", "depth", "painter", "thickness"};

}  // namespace

std::span<const std::string_view> choice_names(OverlapMethod) {
    return method_names;
}

void CloudParams::visit(ParamVisitor& v) {
    v.field(
        {.name = "centre_mm",
         .doc = "Where the contrast leaves the catheter, in the mesh's frame; by default the injection. A "
                "catheter that is part of the vessels is filled from its other end.",
         .unit = "mm"},
        centre_mm);
    v.field({.name = "radius_mm",
             .doc = "Contrast is densest up to two thirds of this distance from the injection and none "
                    "beyond it; 0: no cloud.",
             .unit = "mm",
             .min = 0.0},
            radius_mm);
    v.field({.name = "brightness",
             .doc = "Density of the cloud at the injection while the injection lasts.",
             .min = 0.0,
             .max = 1.0},
            brightness);
    v.field({.name = "threshold", .doc = "Less of the cloud than this is dropped.", .min = 0.0, .max = 1.0},
            threshold);
}

void GeometryParams::visit(ParamVisitor& v) {
    v.field({.name = "vessel", .doc = "The vessels and how contrast gets into them.", .required = true},
            vessel);
    v.field({.name = "bolus", .doc = "What is injected, over time."}, bolus);
    v.field({.name = "cloud", .doc = "The cloud around the injection."}, cloud);
    v.field({.name = "tone", .doc = "Scale of the vessels' density in the picture.", .min = 0.0, .max = 1.0},
            tone);
    v.field({.name = "delay_s",
             .doc = "Draws the vessels as they were this much earlier: for a capillary blush.",
             .unit = "s",
             .min = 0.0},
            delay_s);
    v.field(
        {.name = "method",
         .doc = "max, depth and painter keep the densest fragment; thickness adds vessels up by the way of "
                "the rays through them and needs a centreline and full_calibre_mm. All but max only in a "
                "pass that draws contrast.main alone."},
        method);
}

}  // namespace viscera::contrast

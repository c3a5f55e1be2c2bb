#include "effects/volume/mixed.h"

#include <array>

namespace viscera::volume {
namespace {

constexpr std::array<std::string_view, 2> pass_names{"coarse", "fine"};

}  // namespace

std::span<const std::string_view> choice_names(MixedPass) {
    return pass_names;
}

void MixedParams::visit(ParamVisitor& v) {
    v.field({.name = "pass",
             .doc = "coarse: casts some of the full picture's rays, as many as its target has pixels; fine: "
                    "fills in the others from that, or casts them."},
            pass);
    v.field(
        {.name = "tolerance",
         .doc = "Where the coarse picture bends by more than this, in colour or opacity, from one of its "
                "pixels to the next, the ray is cast (fine); about what linear interpolation would err by.",
         .min = 0.0},
        tolerance);
    v.field({.name = "depth_tolerance_mm",
             .doc = "Where the depth of surfaces is not that interpolated from the coarse picture's by more "
                    "than this, the ray is cast (fine).",
             .unit = "mm",
             .min = 0.0},
            depth_tolerance_mm);
}

int lattice_line(int texel, int texels, int lines) {
    return (2 * texel + 1) * lines / (2 * texels);
}

bool can_fill(glm::ivec2 coarse, glm::ivec2 lattice) {
    return coarse.x >= 4 && coarse.y >= 4 && coarse.x <= lattice.x && coarse.y <= lattice.y;
}

}  // namespace viscera::volume

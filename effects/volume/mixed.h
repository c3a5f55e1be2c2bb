#pragma once

#include <span>
#include <string_view>

#include <glm/glm.hpp>

#include "engine/core/params.h"

namespace viscera::volume {

/// Which of the two passes of a picture in mixed resolution this is.
enum class MixedPass { coarse, fine };
[[nodiscard]] std::span<const std::string_view> choice_names(MixedPass pass);

/// A picture in mixed resolution: a coarse pass casts some of the full picture's rays, a fine one fills in
/// the pixels between where the coarse picture and the surfaces in it are smooth, and casts the rest.
struct MixedParams {
    MixedPass pass = MixedPass::coarse;
    double tolerance = 0.01;
    double depth_tolerance_mm = 0.1;

    void visit(ParamVisitor& v);
};

/// Pixels of the full picture along one axis whose rays the texels of a coarse one hold: texel i has pixel
/// `lattice_line(i, texels, lines)`. texels <= lines: no two texels have one.
[[nodiscard]] int lattice_line(int texel, int texels, int lines);

/// Whether a fine pass can read a coarse picture: at least four texels along each axis, for the cubic between
/// them, and no more than the full picture has pixels.
[[nodiscard]] bool can_fill(glm::ivec2 coarse, glm::ivec2 lattice);

}  // namespace viscera::volume

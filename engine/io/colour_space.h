#pragma once

#include <glm/glm.hpp>

namespace viscera::io {

/// Where colours of a colour map are mixed, as VTK understands the names.
enum class ColourSpace {
    rgb,
    hsv,          ///< straight from hue to hue
    hsv_wrapped,  ///< the short way round the circle of hues
    lab,          ///< CIELAB of sRGB colours, D65
    diverging,    ///< polar CIELAB with white put between colours of distinct hue (Moreland, ISVC 2009)
};

/// The colour at t in [0, 1] between two RGB colours; each component in [0, 1].
[[nodiscard]] glm::dvec3 mix_colours(ColourSpace space, const glm::dvec3& a, const glm::dvec3& b, double t);

}  // namespace viscera::io

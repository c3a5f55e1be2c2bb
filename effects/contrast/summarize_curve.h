#pragma once

#include <algorithm>
#include <span>
#include <string_view>

#include "engine/core/params.h"

namespace viscera::contrast {

/// How the summarize pass crosses the line 0.9 main = r, where the published rule jumps.
enum class SummarizeTransition { smooth, thesis };
[[nodiscard]] std::span<const std::string_view> choice_names(SummarizeTransition transition);

/// Half width of the smooth transition, in units of contrast.
inline constexpr double summarize_width = 0.05;

/// Joins main and cloud at one pixel: the one text that shader and reference follow.
///
///     r      = mix(main, c, q)
///     thesis : distance > 0 and 0.9 main > r  ?  (r + main) / 2  :  r
///     smooth : distance > 0  ?  mix(r, (r + main) / 2, smoothstep(-w, w, 0.9 main - r))  :  r
///
/// with w = summarize_width. smooth needs no blend across distance = 0: there q = 0, so r = main, and both
/// ends of the mix are main.
/// main, c, q, distance: in [0, 1]. Returns a value in [0, 1].
[[nodiscard]] constexpr double summarize(double main, double c, double q, double distance,
                                         SummarizeTransition transition) {
    const double r = main + (c - main) * q;
    if (!(distance > 0.0)) {
        return r;
    }
    const double joined = 0.5 * (r + main);
    const double excess = 0.9 * main - r;
    if (transition == SummarizeTransition::thesis) {
        return excess > 0.0 ? joined : r;
    }
    const double u = std::clamp((excess + summarize_width) / (2.0 * summarize_width), 0.0, 1.0);
    return r + (joined - r) * (u * u * (3.0 - 2.0 * u));
}

}  // namespace viscera::contrast

#pragma once

#include <algorithm>
#include <span>
#include <string_view>

#include "engine/core/params.h"

namespace viscera::contrast {

/// How the summarize pass joins main and cloud.
enum class SummarizeTransition {
    smooth,   ///< crosses the line 0.9 main = r, where the published rule jumps, without a jump
    thesis,   ///< the published rule
    densest,  ///< the cloud never makes a vessel lighter; the others do, which draws a pale ring at its rim
};
[[nodiscard]] std::span<const std::string_view> choice_names(SummarizeTransition transition);

/// Half width of the smooth transition, in units of contrast.
inline constexpr double summarize_width = 0.05;

/// Joins main and cloud at one pixel: the one text that shader and reference follow.
///
///     r      = mix(main, c, q)
///     thesis : q > 0 and 0.9 main > r  ?  (r + main) / 2  :  r
///     smooth : q > 0  ?  mix(r, (r + main) / 2, smoothstep(-w, w, 0.9 main - r))  :  r
///     densest: max(main, r)
///
/// with w = summarize_width. The published rule asks whether the distance map is above 0, which is q before
/// the cloud's threshold. Where the threshold dropped the cloud, c = q = 0, so r = main and both sides of the
/// rule are main: the map changes nothing and need not be drawn. For the same reason smooth needs no blend
/// across q = 0. c, q: in [0, 1], main: at least 0. Returns a value between the least and the largest of 0, c
/// and main.
[[nodiscard]] constexpr double summarize(double main, double c, double q, SummarizeTransition transition) {
    const double r = main + (c - main) * q;
    if (!(q > 0.0)) {
        return main;
    }
    if (transition == SummarizeTransition::densest) {
        return std::max(main, r);
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

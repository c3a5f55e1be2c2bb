#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace viscera::contrast {

/// The contrast curve `S_N(a) = min(1, sum_{i=0}^{N-1} clamp(2 (a - i/N) / (1 - i/N), 0, 1))` in closed form.
///
/// Every term reaches 1 at a = (1 + i/N)/2 >= 1/2, where term 0 alone already makes the sum 1. So up to the
/// saturation point no term is clamped from above, each is max(0, line), and the sum is convex and piecewise
/// linear with knots at a = k/N. A convex piecewise linear function is the maximum of its own lines:
///
///     S_N(a) = min(1, max_k (slope_k a - offset_k)),   k = 0 .. K
///     slope_k  = sum_{i=0}^{k} 2 N / (N - i)
///     offset_k = sum_{i=0}^{k} 2 i / (N - i)
///
/// exactly, with K + 1 = 5 lines for N = 25, saturating at a = 0.17514.
struct OpacityLine {
    double slope = 0.0;
    double offset = 0.0;
};

/// Lines of S_N up to its saturation, at least one. n is clamped to [1, 4096].
[[nodiscard]] std::vector<OpacityLine> opacity_lines(int n);

/// The smallest a with S_N(a) = 1, in (0, 1/2].
[[nodiscard]] double opacity_saturation(int n);

/// S_N(a) by the closed form, in double. a is clamped to [0, 1]; NaN gives 0.
[[nodiscard]] double opacity(double a, int n);

/// The default, N = 25, as the shader has it: five multiply-adds in float, within 3e-7 of the loop.
/// In GLSL, with a in [0, 1]:
///
///     float s = max(2.0 * a, 4.0833335 * a - 0.083333336);
///     s = max(s, max(6.2572465 * a - 0.25724638, 8.529974 * a - 0.52997363));
///     s = min(1.0, max(s, 10.910926 * a - 0.91092604));
inline constexpr int opacity_terms = 25;
inline constexpr std::size_t opacity_line_count = 5;
struct OpacityLineFloat {
    float slope = 0.0F;
    float offset = 0.0F;
};
[[nodiscard]] constexpr std::array<OpacityLineFloat, opacity_line_count> make_opacity_lines_float() {
    std::array<OpacityLineFloat, opacity_line_count> lines{};
    double slope = 0.0;
    double offset = 0.0;
    for (std::size_t k = 0; k < opacity_line_count; ++k) {
        const double i = static_cast<double>(k);
        slope += 2.0 * opacity_terms / (opacity_terms - i);
        offset += 2.0 * i / (opacity_terms - i);
        lines[k] = {static_cast<float>(slope), static_cast<float>(offset)};
    }
    return lines;
}
inline constexpr std::array<OpacityLineFloat, opacity_line_count> opacity_lines_float =
    make_opacity_lines_float();

/// S_25 in float, operation by operation what the GLSL above does.
[[nodiscard]] float opacity_float(float a);

}  // namespace viscera::contrast

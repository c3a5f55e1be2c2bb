#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "effects/volume/bricks.h"
#include "engine/core/transfer_function.h"

namespace viscera::volume {

/// What a texel means: value = scale * texel + offset. `texel` is what a fetch gives: stored / 255 for u8,
/// stored / 65535 for u16, the stored number itself for f32. scale is finite and not 0.
struct TexelMap {
    double scale = 1.0;
    double offset = 0.0;

    [[nodiscard]] double value_of(double texel) const { return scale * texel + offset; }
    [[nodiscard]] double texel_of(double value) const { return (value - offset) / scale; }
};

/// Texels between which a function is wanted; finite, low <= high. Beyond, everything is constant.
struct TexelRange {
    double low = 0.0;
    double high = 1.0;

    /// Shortest distance at which two knots are told apart, 2^-23 of the larger end: two floats at least, and
    /// no denormal number unless the range is.
    [[nodiscard]] double resolution() const;
};

/// A transfer function over the texel instead of the value.
///
/// Steps have a width, so that everything downstream is continuous: a step at texel s runs from s - 3 r to
/// s - r with r = resolution() (from s + r to s + 3 r where scale < 0). At s itself, and one rounding beside
/// it, there is what `evaluate` gives at a step: the side of the larger value. Knots nearer than r to each
/// other are taken for a step.
struct ExtinctionKnots {
    struct Knot {
        float texel;
        glm::dvec4 value;  ///< red, green, blue, opacity per reference length
    };
    std::vector<Knot> knots;           ///< at least one, at least r apart, ascending, inside the range
    double reference_length_mm = 1.0;  ///< > 0

    /// Red, green, blue and opacity at a texel; constant beyond the ends. NaN: transparent.
    [[nodiscard]] glm::dvec4 evaluate(double texel) const;
    /// Red, green, blue and extinction [1/mm].
    [[nodiscard]] glm::dvec4 classify(double texel) const;
    /// The largest extinction [1/mm].
    [[nodiscard]] double most_extinction() const;
};

/// Clipped to the range; knots on the straight line between their neighbours are left out. The function is
/// taken as `normalised` gives it.
[[nodiscard]] ExtinctionKnots extinction_knots(const TransferFunction& function, const TexelMap& map,
                                               const TexelRange& range);

/// Entry i belongs to the texel low + i (high - low) / (n - 1): entries at both ends, so that 256 over [0, 1]
/// are just what a u8 texture can give. In the shader, `place = x * texel + y`, cut to [0, n - 1], and either
/// the nearest entry or the two beside it mixed. Entries are exact; between them lies the chord.
struct ClassificationTable {
    std::vector<glm::vec4> entries;        ///< red, green, blue, extinction [1/mm]
    std::vector<glm::vec4> premultiplied;  ///< extinction * (red, green, blue, 1)
    glm::dvec2 place{0.0};                 ///< x, y

    /// The first entry with extinction; that behind the last one where there is none.
    [[nodiscard]] std::size_t first_seen() const;
    /// The mix of the two entries beside a texel.
    [[nodiscard]] glm::dvec4 mixed(double texel) const;
};
inline constexpr int table_entries = 4096;
/// entries >= 2.
[[nodiscard]] ClassificationTable tabulate(const ExtinctionKnots& knots, const TexelRange& range,
                                           int entries = table_entries);

/// Ranges of stored numbers that can show anything, ascending and disjoint, whichever way the function is
/// evaluated: widened by the width of steps, by one entry of a table of `entries` over `range` (0: no table),
/// and rounded outwards. `map` and `range` are in stored numbers: value = scale * stored + offset. Infinite
/// where all beyond is visible.
[[nodiscard]] std::vector<StoredRange> stored_ranges(const TransferFunction& function, const TexelMap& map,
                                                     const TexelRange& range, int entries = table_entries);

/// The same where the nearest entry of a table is all that is looked at: what shows nothing there may touch
/// what does, so that a background at a knot of opacity 0 is empty. `range`: of the table, in texels;
/// `stored_of_texel`: scale > 0.
[[nodiscard]] std::vector<StoredRange> stored_ranges(const ClassificationTable& table,
                                                     const TexelRange& range,
                                                     const TexelMap& stored_of_texel);

/// Opacity of a length of constant extinction, 1 - exp(-extinction length).
[[nodiscard]] double opacity_of(double extinction_per_mm, double length_mm);

}  // namespace viscera::volume

#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "effects/volume/classification.h"

namespace viscera::volume {

/// Means of extinction and of extinction times colour between any two texels a and b: what a slab of a ray
/// holds along which the value runs straight from a to b (pre-integrated classification).
///
/// A plain table of the running integral K, sampled evenly, fails twice: steps and narrow peaks fall between
/// its entries, and (K(b) - K(a)) / (b - a) cancels where a and b are near. Here the function is cut into
/// pieces at its knots, finely enough that a parabola
///
///     q(t) = c0 + c1 t + c2 t^2,   t = (x - start) / (end - start)
///
/// through both ends and with the exact integral misses extinction * (r, g, b, 1) by less than 2e-6 of the
/// largest extinction. Between knots nearer than step_width, at steps above all, extinction * (r, g, b, 1) is
/// taken to run straight. For a <= b in the pieces i and j, with s and e their starts and ends:
///
///     i = j:  mean = c0 + c1 (ta + tb) / 2 + c2 (ta^2 + ta tb + tb^2) / 3
///     i < j:  mean = ((e_i - a) mean_i(ta, 1) + (K(s_j) - K(e_i)) + (b - s_j) mean_j(0, tb)) / (b - a)
///
/// The first has no difference and holds for a = b, where it is the function itself. In the second all terms
/// are positive, and K is kept as the sum of two floats, high + low, so that K(s_j) - K(e_i), formed as
/// (high_j - high_i) + (low_j - low_i), is good to a few roundings of itself however small it is.
///
/// For the GPU: a picture RGBA32F, `texels`, one column per piece and six rows (start, end, 1 / (end -
/// start), 0), c0, c1, c2, K high and K low at the start; K(e_i) is that of column i + 1. The piece of x is
/// the last that starts at or before x; it is among bins[clamp(int(x * bin.x + bin.y), 0, bins - 1)], to be
/// halved until one is left: mostly it is one from the outset. Both outer pieces are constant and as long as
/// the range; x is cut to them.
struct SlabTable {
    static constexpr int rows = 6;
    [[nodiscard]] static double step_width(const TexelRange& range) { return 3.5 * range.resolution(); }

    /// The pieces that texels of a bin may lie in, both included.
    struct Bin {
        std::uint16_t first;
        std::uint16_t last;
    };

    int pieces = 0;
    std::vector<glm::vec4> texels;  ///< rows * pieces, row after row
    std::vector<Bin> bins;
    glm::vec2 bin{0.0F};  ///< texel -> bin

    /// Mean of extinction * (red, green, blue, 1) [1/mm] between two texels in any order, in float, operation
    /// by operation what a shader does. NaN gives 0.
    [[nodiscard]] glm::vec4 mean(float a, float b) const;
};

inline constexpr int slab_bins = 1024;
inline constexpr int most_slab_pieces = 8192;

/// bins >= 1. Where `most_pieces` (at least 256, at most 65535) does not suffice the parabolas are allowed to
/// miss by more, and at last neighbouring knots are joined.
[[nodiscard]] SlabTable tabulate_slabs(const ExtinctionKnots& knots, const TexelRange& range,
                                       int bins = slab_bins, int most_pieces = most_slab_pieces);

}  // namespace viscera::volume

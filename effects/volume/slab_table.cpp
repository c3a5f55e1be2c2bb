#include "effects/volume/slab_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace viscera::volume {
namespace {

using Knot = ExtinctionKnots::Knot;

/// A parabola over [start, end].
struct Piece {
    float start;
    float end;
    glm::dvec4 c0;
    glm::dvec4 c1;
    glm::dvec4 c2;

    [[nodiscard]] double width() const { return static_cast<double>(end) - static_cast<double>(start); }
    [[nodiscard]] glm::dvec4 at(double t) const { return c0 + t * (c1 + t * c2); }
    [[nodiscard]] glm::dvec4 mean() const { return c0 + c1 / 2.0 + c2 / 3.0; }
};

/// Extinction * (red, green, blue, 1) between two knots.
class TableSegment {
  public:
    TableSegment(const Knot& a, const Knot& b, double reference_length_mm)
        : a_(a), b_(b), reference_length_mm_(reference_length_mm) {}

    [[nodiscard]] glm::dvec4 at(double texel) const {
        const double start = static_cast<double>(a_.texel);
        const double t = (texel - start) / (static_cast<double>(b_.texel) - start);
        const glm::dvec4 value = a_.value * (1.0 - t) + b_.value * t;
        return glm::dvec4(glm::dvec3(value), 1.0) * extinction(value.w, reference_length_mm_);
    }

  private:
    const Knot& a_;
    const Knot& b_;
    double reference_length_mm_;
};

/// Mean over [start, end] by Gauss-Legendre quadrature with 8 points. The only singularity of -log(1 - A) is
/// where A is 1, and pieces are short against their distance from it.
glm::dvec4 mean_of(const TableSegment& segment, double start, double end) {
    constexpr std::array<double, 4> nodes{0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                                          0.96028985649753623};
    constexpr std::array<double, 4> weights{0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                            0.10122853629037626};
    const double middle = (start + end) / 2.0;
    const double half = (end - start) / 2.0;
    glm::dvec4 sum(0.0);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        sum += weights[i] * (segment.at(middle - half * nodes[i]) + segment.at(middle + half * nodes[i]));
    }
    return sum / 2.0;
}

/// As mean_of, for an interval that may reach where A is 1: halved until halving changes nothing.
glm::dvec4 careful_mean_of(const TableSegment& segment, double start, double end, double tolerance,
                           int halvings) {
    const double middle = (start + end) / 2.0;
    const glm::dvec4 left = mean_of(segment, start, middle);
    const glm::dvec4 right = mean_of(segment, middle, end);
    const glm::dvec4 change = glm::abs((left + right) / 2.0 - mean_of(segment, start, end));
    if (halvings == 0 || std::max({change.x, change.y, change.z, change.w}) <= tolerance) {
        return (left + right) / 2.0;
    }
    return (careful_mean_of(segment, start, middle, tolerance, halvings - 1) +
            careful_mean_of(segment, middle, end, tolerance, halvings - 1)) /
           2.0;
}

/// Through both ends, with this mean.
Piece parabola(const TableSegment& segment, float start, float end, const glm::dvec4& mean) {
    const glm::dvec4 a = segment.at(static_cast<double>(start));
    const glm::dvec4 b = segment.at(static_cast<double>(end));
    const glm::dvec4 bend = 3.0 * (a + b) - 6.0 * mean;
    return {start, end, a, b - a - bend, bend};
}

Piece straight(const TableSegment& segment, float start, float end) {
    const glm::dvec4 a = segment.at(static_cast<double>(start));
    return {start, end, a, segment.at(static_cast<double>(end)) - a, glm::dvec4(0.0)};
}

bool fits(const Piece& piece, const TableSegment& segment, double tolerance) {
    for (const double t : {0.07, 0.21, 0.35, 0.65, 0.79, 0.93}) {
        const glm::dvec4 miss =
            glm::abs(piece.at(t) - segment.at(static_cast<double>(piece.start) + t * piece.width()));
        if (!(std::max({miss.x, miss.y, miss.z, miss.w}) <= tolerance)) {
            return false;
        }
    }
    return true;
}

struct Cut {
    double tolerance;
    double least_width;
    std::size_t most;  ///< pieces
};

void cut(const TableSegment& segment, float start, float end, const Cut& how, std::vector<Piece>& pieces) {
    if (pieces.size() >= how.most) {
        return;
    }
    const double from = static_cast<double>(start);
    const double to = static_cast<double>(end);
    const Piece piece = parabola(segment, start, end, mean_of(segment, from, to));
    if (fits(piece, segment, how.tolerance)) {
        pieces.push_back(piece);
        return;
    }
    const float middle = start + (end - start) / 2.0F;
    if (!(middle > start && middle < end && piece.width() > how.least_width)) {
        const glm::dvec4 mean = careful_mean_of(segment, from, to, how.tolerance / 8.0, 20);
        pieces.push_back(parabola(segment, start, end, mean));
        return;
    }
    cut(segment, start, middle, how, pieces);
    cut(segment, middle, end, how, pieces);
}

Piece constant(const ExtinctionKnots& knots, double start, double end, const Knot& knot) {
    const double sigma = extinction(knot.value.w, knots.reference_length_mm);
    return {static_cast<float>(start), static_cast<float>(end),
            glm::dvec4(glm::dvec3(knot.value), 1.0) * sigma, glm::dvec4(0.0), glm::dvec4(0.0)};
}

/// Pieces over [-range, 2 range], at most `how.most`; fewer than needed where they do not suffice.
std::vector<Piece> pieces_of(const ExtinctionKnots& knots, const TexelRange& range, const Cut& how) {
    const double width = std::max(range.high - range.low, 16.0 * range.resolution());
    const Knot& first = knots.knots.front();
    const Knot& last = knots.knots.back();
    std::vector<Piece> pieces{constant(knots, range.low - width, static_cast<double>(first.texel), first)};
    for (std::size_t i = 1; i < knots.knots.size(); ++i) {
        const Knot& a = knots.knots[i - 1];
        const Knot& b = knots.knots[i];
        const TableSegment segment(a, b, knots.reference_length_mm);
        const double gap = static_cast<double>(b.texel) - static_cast<double>(a.texel);
        if (gap < SlabTable::step_width(range)) {
            pieces.push_back(straight(segment, a.texel, b.texel));
        } else {
            cut(segment, a.texel, b.texel, how, pieces);
        }
    }
    pieces.push_back(constant(knots, static_cast<double>(last.texel), range.high + width, last));
    return pieces;
}

/// Half of the knots: the function is coarser, but keeps its ends.
ExtinctionKnots thinned(const ExtinctionKnots& knots) {
    ExtinctionKnots thin;
    thin.reference_length_mm = knots.reference_length_mm;
    for (std::size_t i = 0; i < knots.knots.size(); ++i) {
        if (i % 2 == 0 || i + 1 == knots.knots.size()) {
            thin.knots.push_back(knots.knots[i]);
        }
    }
    return thin;
}

std::vector<Piece> affordable_pieces(ExtinctionKnots knots, const TexelRange& range, std::size_t most) {
    while (knots.knots.size() + 1 > most) {
        knots = thinned(knots);
    }
    const double largest = knots.most_extinction();
    double tolerance = 2e-6;
    while (tolerance < 1.0) {
        const Cut how{tolerance * largest, range.resolution() / 8.0, most + 1};
        std::vector<Piece> pieces = pieces_of(knots, range, how);
        if (pieces.size() <= most) {
            return pieces;
        }
        tolerance *= 4.0;
    }
    return pieces_of(knots, range, {2.0 * largest, range.resolution() / 8.0, most});
}

void fill_texels(SlabTable& table, std::span<const Piece> pieces) {
    const std::size_t count = pieces.size();
    table.pieces = static_cast<int>(count);
    table.texels.resize(SlabTable::rows * count);
    glm::dvec4 integral(0.0);
    for (std::size_t i = 0; i < count; ++i) {
        const Piece& piece = pieces[i];
        const glm::vec4 high(integral);
        const auto inverse = static_cast<float>(1.0 / piece.width());
        const std::array<glm::vec4, SlabTable::rows> column{glm::vec4(piece.start, piece.end, inverse, 0.0F),
                                                            piece.c0,
                                                            piece.c1,
                                                            piece.c2,
                                                            high,
                                                            integral - glm::dvec4(high)};
        for (std::size_t row = 0; row < column.size(); ++row) {
            table.texels[row * count + i] = column[row];
        }
        integral += piece.mean() * piece.width();
    }
}

void fill_bins(SlabTable& table, std::span<const Piece> pieces, const TexelRange& range, std::size_t bins) {
    const double slack = 4.0 * range.resolution();
    const double width = std::max(range.high - range.low, 16.0 * range.resolution());
    table.bin.x = static_cast<float>(static_cast<double>(bins) / width);
    table.bin.y = static_cast<float>(-range.low * static_cast<double>(bins) / width);
    const auto piece_at = [&](double texel) {
        const auto after = std::ranges::upper_bound(
            pieces, texel, {}, [](const Piece& piece) { return static_cast<double>(piece.start); });
        return std::max<std::ptrdiff_t>(after - pieces.begin(), 1) - 1;
    };
    table.bins.resize(bins);
    for (std::size_t i = 0; i < bins; ++i) {
        // A texel at the edge may be rounded into either bin.
        const double start = range.low + width * static_cast<double>(i) / static_cast<double>(bins);
        const double end = start + width / static_cast<double>(bins) + slack;
        const std::ptrdiff_t first = i == 0 ? 0 : piece_at(start - slack);
        const std::ptrdiff_t last = i + 1 == bins ? std::ssize(pieces) - 1 : piece_at(end);
        table.bins[i] = {static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(last)};
    }
}

std::size_t find(const SlabTable& table, float x) {
    const float last_bin = static_cast<float>(table.bins.size() - 1);
    const float bin = std::clamp(x * table.bin.x + table.bin.y, 0.0F, last_bin);
    const SlabTable::Bin pieces = table.bins[static_cast<std::size_t>(bin)];
    std::size_t first = pieces.first;
    std::size_t last = pieces.last;
    while (first < last) {
        const std::size_t middle = (first + last + 1) / 2;
        if (x >= table.texels[middle].x) {
            first = middle;
        } else {
            last = middle - 1;
        }
    }
    return first;
}

glm::vec4 piece_mean(const SlabTable& table, std::size_t piece, float ta, float tb) {
    const auto count = static_cast<std::size_t>(table.pieces);
    return table.texels[count + piece] + table.texels[2 * count + piece] * (0.5F * (ta + tb)) +
           table.texels[3 * count + piece] * ((ta * ta + ta * tb + tb * tb) * (1.0F / 3.0F));
}

}  // namespace

SlabTable tabulate_slabs(const ExtinctionKnots& knots, const TexelRange& range, int bins, int most_pieces) {
    const std::vector<Piece> pieces =
        affordable_pieces(knots, range, static_cast<std::size_t>(std::clamp(most_pieces, 256, 65535)));
    SlabTable table;
    fill_texels(table, pieces);
    fill_bins(table, pieces, range, static_cast<std::size_t>(std::max(bins, 1)));
    return table;
}

glm::vec4 SlabTable::mean(float a, float b) const {
    if (std::isnan(a) || std::isnan(b)) {
        return glm::vec4(0.0F);
    }
    const auto count = static_cast<std::size_t>(pieces);
    const float low = texels[0].x;
    const float high = texels[count - 1].y;
    const float from = std::clamp(std::min(a, b), low, high);
    const float to = std::clamp(std::max(a, b), low, high);
    const std::size_t i = find(*this, from);
    const std::size_t j = find(*this, to);
    const glm::vec4 head_i = texels[i];
    const glm::vec4 head_j = texels[j];
    const float ti = (from - head_i.x) * head_i.z;
    const float tj = (to - head_j.x) * head_j.z;
    if (i == j) {
        return piece_mean(*this, i, ti, tj);
    }
    const glm::vec4 between = (texels[4 * count + j] - texels[4 * count + i + 1]) +
                              (texels[5 * count + j] - texels[5 * count + i + 1]);
    return ((head_i.y - from) * piece_mean(*this, i, ti, 1.0F) + between +
            (to - head_j.x) * piece_mean(*this, j, 0.0F, tj)) /
           (to - from);
}

}  // namespace viscera::volume

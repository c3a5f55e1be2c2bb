#pragma once

#include <functional>

#include "tests/reference/volume_field.h"
#include "tests/reference/volume_ray.h"

namespace viscera::reference {

/// Stretch of a ray on which the field is one polynomial: value(u), u = -1 at begin and 1 at end.
struct Piece {
    Interval s;
    Polynomial value;

    [[nodiscard]] double u_of(double s_mm) const { return (2.0 * s_mm - s.begin - s.end) / s.length(); }
    [[nodiscard]] double s_of(double u) const { return 0.5 * (s.begin + s.end + u * s.length()); }
    /// ds/du [mm].
    [[nodiscard]] double half_mm() const { return 0.5 * s.length(); }
};

/// Called for each piece, in order along the ray; false stops.
using PieceVisitor = std::function<bool(const Piece&)>;

/// The field along a ray as polynomials, without a gap from begin to end. A voxel field is cut at its cells'
/// faces and exact (degree 0 nearest, 3 trilinear, 9 tricubic). An analytic field is cut by halves, from 16
/// equal stretches on, until a Chebyshev interpolant of degree 9 reaches 1e-13 of the largest value met,
/// or what rounding allows; jumps and kinks are cut down to 2^-40 of the ray. At most 20000 interpolants a
/// ray: a field that needs more is cut more coarsely at the ray's end.
void visit_pieces(const Field& field, const Ray& ray, const Interval& interval, const PieceVisitor& visit);

/// The field at a place of the ray, by Field::value.
[[nodiscard]] double value_at(const Field& field, const Ray& ray, double s_mm);

}  // namespace viscera::reference

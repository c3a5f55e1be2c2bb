#include "tests/reference/volume_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace viscera::reference {
namespace {

constexpr std::size_t nodes = Polynomial::max_degree + 1;
using Row = std::array<double, nodes>;
/// Of an interpolant, relative to the largest value met on the ray.
constexpr double precision = 1e-13;
/// Interpolants tried per ray, so that a field that is nowhere smooth ends too.
constexpr int most_interpolants = 20000;

/// A line in texture or index coordinates.
struct Line {
    glm::dvec3 origin;
    glm::dvec3 direction;

    [[nodiscard]] glm::dvec3 at(double s) const { return origin + s * direction; }
};

Line in_texture(const Field& field, const Ray& ray) {
    return {glm::dvec3(field.world_to_texture() * glm::dvec4(ray.origin_mm, 1.0)),
            glm::dvec3(field.world_to_texture() * glm::dvec4(ray.direction, 0.0))};
}

void visit_cells(const Field& field, const Ray& ray, const Interval& interval, const PieceVisitor& visit) {
    const Line texture = in_texture(field, ray);
    const glm::dvec3 dims(field.dims());
    const double shift = field.filter() == Filter::nearest ? 0.0 : 0.5;
    // Faces between cells lie at whole x.
    const Line line{texture.origin * dims - shift, texture.direction * dims};
    const glm::dvec3 start = line.at(interval.begin);
    glm::ivec3 cell;
    glm::ivec3 step;
    const auto next_face = [&](int axis) {
        if (step[axis] == 0) {
            return std::numeric_limits<double>::infinity();
        }
        return (cell[axis] + (step[axis] > 0 ? 1 : 0) - line.origin[axis]) / line.direction[axis];
    };
    glm::dvec3 next;
    for (int axis = 0; axis < 3; ++axis) {
        const double d = line.direction[axis];
        step[axis] = d > 0.0 ? 1 : (d < 0.0 ? -1 : 0);
        cell[axis] = static_cast<int>(std::clamp(std::floor(start[axis]), -4.0, dims[axis] + 4.0));
        next[axis] = next_face(axis);
    }
    const double index_shift = shift - 0.5;  // from x to index coordinates
    double begin = interval.begin;
    while (begin < interval.end) {
        const int axis = next.x <= next.y ? (next.x <= next.z ? 0 : 2) : (next.y <= next.z ? 1 : 2);
        const double end = std::min(next[axis], interval.end);
        if (end > begin) {
            const glm::dvec3 middle = line.at(0.5 * (begin + end)) + index_shift;
            const glm::dvec3 half = 0.5 * (end - begin) * line.direction;
            if (!visit({{begin, end}, field.along(cell, middle, half)})) {
                return;
            }
            begin = end;
        }
        cell[axis] += step[axis];
        next[axis] = next_face(axis);
    }
}

/// Values at Chebyshev nodes of degree 9 -> Chebyshev coefficients -> powers of u.
struct Chebyshev {
    Row u{};
    std::array<Row, nodes> to_coefficients{};  ///< row: coefficient, column: node
    std::array<Row, nodes> to_powers{};        ///< row: power, column: coefficient

    Chebyshev() {
        for (std::size_t i = 0; i < nodes; ++i) {
            const double angle = std::numbers::pi * (static_cast<double>(i) + 0.5) / nodes;
            u[i] = std::cos(angle);
            for (std::size_t k = 0; k < nodes; ++k) {
                to_coefficients[k][i] =
                    (k == 0 ? 1.0 : 2.0) / nodes * std::cos(static_cast<double>(k) * angle);
            }
        }
        to_powers[0][0] = 1.0;
        to_powers[1][1] = 1.0;
        for (std::size_t k = 2; k < nodes; ++k) {  // T_k = 2 u T_(k-1) - T_(k-2)
            for (std::size_t j = 0; j < nodes; ++j) {
                to_powers[j][k] = (j > 0 ? 2.0 * to_powers[j - 1][k - 1] : 0.0) - to_powers[j][k - 2];
            }
        }
    }
};

/// Cuts an analytic field into polynomials.
class Cutter {
  public:
    Cutter(const Field& field, const Ray& ray, const PieceVisitor& visit)
        : field_(field), line_(in_texture(field, ray)), visit_(visit) {}

    bool cut(const Interval& s, int depth) {
        static const Chebyshev chebyshev;
        Row values;
        for (std::size_t i = 0; i < nodes; ++i) {
            values[i] = at(s, chebyshev.u[i]);
            scale_ = std::max(scale_, std::abs(values[i]));
        }
        Row coefficients{};
        for (std::size_t k = 0; k < nodes; ++k) {
            for (std::size_t i = 0; i < nodes; ++i) {
                coefficients[k] += chebyshev.to_coefficients[k][i] * values[i];
            }
        }
        Piece piece{s, {}};
        piece.value.degree = Polynomial::max_degree;
        for (std::size_t j = 0; j < nodes; ++j) {
            for (std::size_t k = j; k < nodes; ++k) {
                piece.value.c[j] += chebyshev.to_powers[j][k] * coefficients[k];
            }
        }
        const double tail = std::abs(coefficients[nodes - 1]) + std::abs(coefficients[nodes - 2]);
        // The ends are no nodes, so they show what the nodes did not see.
        const double miss =
            std::max(std::abs(piece.value(-1.0) - at(s, -1.0)), std::abs(piece.value(1.0) - at(s, 1.0)));
        const double middle = 0.5 * (s.begin + s.end);
        // The place on the ray is rounded, which makes a steep field noisy; cutting does not help there.
        const auto [low, high] = std::ranges::minmax(values);
        const double noise = 1e-15 * std::max(std::abs(s.begin), std::abs(s.end)) / s.length() * (high - low);
        --budget_;
        const bool fits = std::max(tail, miss) <= precision * scale_ + noise || budget_ < 0;
        if (fits || depth <= 0 || !(middle > s.begin && middle < s.end)) {
            return visit_(piece);
        }
        return cut({s.begin, middle}, depth - 1) && cut({middle, s.end}, depth - 1);
    }

  private:
    [[nodiscard]] double at(const Interval& s, double u) const {
        return field_.value(line_.at(0.5 * (s.begin + s.end + u * s.length())));
    }

    const Field& field_;
    Line line_;
    const PieceVisitor& visit_;
    double scale_ = 1e-300;
    int budget_ = most_interpolants;
};

}  // namespace

void visit_pieces(const Field& field, const Ray& ray, const Interval& interval, const PieceVisitor& visit) {
    if (!field.analytic()) {
        visit_cells(field, ray, interval, visit);
        return;
    }
    constexpr int stretches = 16;
    Cutter cutter(field, ray, visit);
    double begin = interval.begin;
    for (int i = 1; i <= stretches; ++i) {
        const double end = i == stretches ? interval.end : interval.begin + interval.length() * i / stretches;
        if (!cutter.cut({begin, end}, 36)) {
            return;
        }
        begin = end;
    }
}

double value_at(const Field& field, const Ray& ray, double s_mm) {
    return field.value(in_texture(field, ray).at(s_mm));
}

}  // namespace viscera::reference

#pragma once

#include <array>
#include <cstddef>

namespace viscera::reference {

/// Polynomial in u, meant for u in [-1, 1]; c[k] is the coefficient of u^k. A trilinear field along a ray is
/// of degree 3 within a cell, a tricubic one of degree 9.
struct Polynomial {
    static constexpr int max_degree = 9;
    std::array<double, max_degree + 1> c{};
    int degree = 0;

    [[nodiscard]] double operator()(double u) const {
        double value = c[static_cast<std::size_t>(degree)];
        for (int k = degree - 1; k >= 0; --k) {
            value = value * u + c[static_cast<std::size_t>(k)];
        }
        return value;
    }
    [[nodiscard]] Polynomial derivative() const;
    /// Integral from a to b.
    [[nodiscard]] double integral(double a, double b) const;
};

/// Bounds (not the extremes) of a polynomial over [-1, 1].
struct Bounds {
    double low = 0.0;
    double high = 0.0;
};
[[nodiscard]] Bounds bounds(const Polynomial& p);

/// At most one root per monotone stretch of a polynomial, ascending.
struct Roots {
    std::array<double, Polynomial::max_degree + 1> u{};
    int count = 0;

    void add(double root) { u[static_cast<std::size_t>(count++)] = root; }
    [[nodiscard]] const double* begin() const { return u.data(); }
    [[nodiscard]] const double* end() const { return u.data() + count; }
};

/// Where `p` changes between >= 0 and < 0 in (a, b]: every change is found, to rounding error, because the
/// monotone stretches between the roots of the derivative are searched one by one. A touch without a change
/// is no root.
[[nodiscard]] Roots sign_changes(const Polynomial& p, double a, double b);

/// Extremes of `p` over [a, b], interior ones included.
[[nodiscard]] Bounds extremes(const Polynomial& p, double a, double b);

}  // namespace viscera::reference

#include "tests/reference/volume_polynomial.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace viscera::reference {
namespace {

/// Root in [a, b] of a stretch whose ends differ in sign: Newton's method, kept inside the bracket.
double bracketed_root(const Polynomial& p, const Polynomial& slope, double a, double b) {
    const bool high_at_b = p(b) >= 0.0;
    double u = 0.5 * (a + b);
    for (int i = 0; i < 200; ++i) {
        const double value = p(u);
        ((value >= 0.0) == high_at_b ? b : a) = u;
        double next = u - value / slope(u);
        if (!(next > a && next < b)) {
            next = 0.5 * (a + b);
        }
        if (std::abs(next - u) <= 1e-16 || next == u) {
            return next;
        }
        u = next;
    }
    return u;
}

/// Roots of c0 + c1 u + c2 u^2 without cancellation, in (a, b), ascending.
Roots quadratic_roots(const Polynomial& p, double a, double b) {
    Roots roots;
    const double discriminant = p.c[1] * p.c[1] - 4.0 * p.c[2] * p.c[0];
    if (!(discriminant >= 0.0)) {
        return roots;
    }
    const double q = -0.5 * (p.c[1] + std::copysign(std::sqrt(discriminant), p.c[1]));
    double first = q / p.c[2];
    double second = p.c[0] / q;
    if (!(first <= second)) {
        std::swap(first, second);
    }
    for (const double root : {first, second}) {
        if (root > a && root < b) {
            roots.add(root);
        }
    }
    return roots;
}

/// Where `p` turns between rising and falling, in (a, b).
Roots turning_points(const Polynomial& p, double a, double b) {
    const Polynomial slope = p.derivative();
    return slope.degree == 2 ? quadratic_roots(slope, a, b) : sign_changes(slope, a, b);
}

}  // namespace

Polynomial Polynomial::derivative() const {
    Polynomial result;
    result.degree = std::max(degree - 1, 0);
    for (int k = 1; k <= degree; ++k) {
        result.c[static_cast<std::size_t>(k - 1)] = k * c[static_cast<std::size_t>(k)];
    }
    return result;
}

double Polynomial::integral(double a, double b) const {
    const auto primitive = [&](double u) {
        double value = 0.0;
        for (int k = degree; k >= 0; --k) {
            value = (value + c[static_cast<std::size_t>(k)] / (k + 1)) * u;
        }
        return value;
    };
    return primitive(b) - primitive(a);
}

Bounds bounds(const Polynomial& p) {
    double reach = 0.0;
    for (int k = 1; k <= p.degree; ++k) {
        reach += std::abs(p.c[static_cast<std::size_t>(k)]);
    }
    return {p.c[0] - reach, p.c[0] + reach};
}

Roots sign_changes(const Polynomial& p, double a, double b) {
    Roots roots;
    if (p.degree == 0) {
        return roots;
    }
    const Polynomial slope = p.derivative();
    const Roots turns = turning_points(p, a, b);
    double left = a;
    bool high_at_left = p(left) >= 0.0;
    for (int i = 0; i <= turns.count; ++i) {
        const double right = i < turns.count ? turns.u[static_cast<std::size_t>(i)] : b;
        const bool high_at_right = p(right) >= 0.0;
        if (high_at_left != high_at_right) {
            roots.add(bracketed_root(p, slope, left, right));
        }
        left = right;
        high_at_left = high_at_right;
    }
    return roots;
}

Bounds extremes(const Polynomial& p, double a, double b) {
    const double at_a = p(a);
    const double at_b = p(b);
    Bounds result{std::min(at_a, at_b), std::max(at_a, at_b)};
    if (p.degree >= 2) {
        for (const double u : turning_points(p, a, b)) {
            result.low = std::min(result.low, p(u));
            result.high = std::max(result.high, p(u));
        }
    }
    return result;
}

}  // namespace viscera::reference

#include "tests/reference/volume_forms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace viscera::reference {
namespace {

using std::numbers::inv_sqrtpi;
using std::numbers::pi;
using std::numbers::sqrt2;

/// sum_k sign^k (2k - 1)!! / (2 x^2)^k, which converges to rounding error for x >= 10 long before its terms
/// grow again.
double asymptotic_sum(double x, double sign) {
    double sum = 1.0;
    double term = 1.0;
    for (int k = 1; k < 60 && std::abs(term) > 1e-18; ++k) {
        term *= sign * (2.0 * k - 1.0) / (2.0 * x * x);
        sum += term;
    }
    return sum;
}

/// exp(x^2) with the rounding error of x^2 put back.
double exp_square(double x) {
    const double square = x * x;
    return std::exp(square) * (1.0 + std::fma(x, x, -square));
}

/// Chord of the unit circle or sphere, for a line o + t d with d of any length; 0 where it misses.
double unit_chord(double oo, double od, double dd) {
    const double discriminant = od * od - dd * (oo - 1.0);
    return discriminant > 0.0 ? 2.0 * std::sqrt(discriminant) / dd : 0.0;
}

std::vector<glm::dvec4> touching_planes(std::span<const glm::dvec3> outward, const glm::dvec3& centre,
                                        double inradius) {
    std::vector<glm::dvec4> planes;
    for (const glm::dvec3& direction : outward) {
        const glm::dvec3 n = glm::normalize(direction);
        planes.emplace_back(-n, glm::dot(n, centre) + inradius);
    }
    return planes;
}

}  // namespace

double erfcx(double x) {
    if (x < 0.0) {
        return 2.0 * exp_square(x) - erfcx(-x);
    }
    return x < 10.0 ? exp_square(x) * std::erfc(x) : inv_sqrtpi / x * asymptotic_sum(x, -1.0);
}

double dawson(double x) {
    if (std::abs(x) >= 10.0) {
        return 0.5 / x * asymptotic_sum(x, 1.0);
    }
    // exp(-x^2) sum x^(2k+1) / (k! (2k+1)): no term has another sign than x.
    double power = x;
    double sum = x;
    for (int k = 1; k < 1000; ++k) {
        power *= x * x / k;
        const double term = power / (2.0 * k + 1.0);
        sum += term;
        if (std::abs(term) <= 1e-18 * std::abs(sum)) {
            break;
        }
    }
    return sum / exp_square(x);
}

Approach approach(const Ray& ray, const glm::dvec3& centre) {
    const glm::dvec3 oc = ray.origin_mm - centre;
    const double s = -glm::dot(oc, ray.direction);
    // From the nearest place itself: |oc|^2 - s^2 would cancel for a far origin.
    const glm::dvec3 nearest = oc + s * ray.direction;
    return {s, glm::dot(nearest, nearest)};
}

double homogeneous_transmittance(double sigma, double length) {
    return std::exp(-sigma * length);
}

double opacity_for_step(double opacity, double ds, double ds2) {
    return -std::expm1(std::log1p(-opacity) * ds2 / ds);
}

double sphere_chord(const Ray& ray, const glm::dvec3& centre, double radius) {
    const double q = radius * radius - approach(ray, centre).b2;
    return q > 0.0 ? 2.0 * std::sqrt(q) : 0.0;
}

double shell_chord(const Ray& ray, const glm::dvec3& centre, double inner, double outer) {
    return sphere_chord(ray, centre, outer) - sphere_chord(ray, centre, inner);
}

double ellipsoid_chord(const Ray& ray, const glm::dvec3& centre, const glm::dvec3& half_axes) {
    const glm::dvec3 o = (ray.origin_mm - centre) / half_axes;
    const glm::dvec3 d = ray.direction / half_axes;
    return unit_chord(glm::dot(o, o), glm::dot(o, d), glm::dot(d, d));
}

double cylinder_chord(const Ray& ray, const glm::dvec3& centre, double radius) {
    const glm::dvec2 o = glm::dvec2(ray.origin_mm - centre) / radius;
    const glm::dvec2 d = glm::dvec2(ray.direction) / radius;
    if (glm::dot(d, d) == 0.0) {
        return glm::dot(o, o) < 1.0 ? std::numeric_limits<double>::infinity() : 0.0;
    }
    return unit_chord(glm::dot(o, o), glm::dot(o, d), glm::dot(d, d));
}

double polyhedron_chord(const Ray& ray, std::span<const glm::dvec4> half_spaces) {
    double begin = -std::numeric_limits<double>::infinity();
    double end = std::numeric_limits<double>::infinity();
    for (const glm::dvec4& plane : half_spaces) {
        const double offset = glm::dot(plane, glm::dvec4(ray.origin_mm, 1.0));
        const double slope = glm::dot(glm::dvec3(plane), ray.direction);
        if (slope > 0.0) {
            begin = std::max(begin, -offset / slope);
        } else if (slope < 0.0) {
            end = std::min(end, -offset / slope);
        } else if (offset < 0.0) {
            return 0.0;
        }
    }
    return std::max(0.0, end - begin);
}

std::vector<glm::dvec4> tetrahedron(const glm::dvec3& centre, double inradius) {
    const std::array<glm::dvec3, 4> outward{
        {{1.0, 1.0, 1.0}, {1.0, -1.0, -1.0}, {-1.0, 1.0, -1.0}, {-1.0, -1.0, 1.0}}};
    return touching_planes(outward, centre, inradius);
}

std::vector<glm::dvec4> octahedron(const glm::dvec3& centre, double inradius) {
    std::vector<glm::dvec3> outward;
    for (int corner = 0; corner < 8; ++corner) {
        outward.emplace_back((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0,
                             (corner & 4) != 0 ? 1.0 : -1.0);
    }
    return touching_planes(outward, centre, inradius);
}

double parabolic_ball(const Ray& ray, const glm::dvec3& centre, double radius) {
    const double q = radius * radius - approach(ray, centre).b2;
    return q > 0.0 ? 4.0 / 3.0 * q * std::sqrt(q) / (radius * radius) : 0.0;
}

double conic_ball(const Ray& ray, const glm::dvec3& centre, double radius) {
    const double b2 = approach(ray, centre).b2;
    const double q = radius * radius - b2;
    if (!(q > 0.0)) {
        return 0.0;
    }
    const double h = std::sqrt(q);
    const double bend = b2 > 0.0 ? b2 * std::log((h + radius) / std::sqrt(b2)) : 0.0;
    return 2.0 * h - (h * radius + bend) / radius;
}

double gaussian_integral(const Ray& ray, const Interval& interval, const glm::dvec3& centre, double amplitude,
                         double sigma) {
    const Approach near = approach(ray, centre);
    const double scale = 1.0 / (sigma * sqrt2);
    return amplitude * std::exp(-near.b2 * scale * scale) * sigma * std::sqrt(pi / 2.0) *
           (std::erf((interval.end - near.s) * scale) - std::erf((interval.begin - near.s) * scale));
}

RampLight ramp_light(const Ramp& ramp) {
    const double s0 = ramp.s0;
    const double s1 = ramp.s0 + ramp.g * ramp.length;
    const double tau = ramp.k * ramp.length * 0.5 * (s0 + s1);
    if (ramp.g == 0.0) {
        return {-std::expm1(-tau) * (ramp.c0 + ramp.c1 * s0), tau};
    }
    const double q = std::sqrt(ramp.k / (2.0 * std::abs(ramp.g)));
    const double last = std::exp(-tau);
    // int exp(-tau) dt
    const double clear =
        ramp.g > 0.0 ? std::sqrt(pi / (2.0 * ramp.k * ramp.g)) * (erfcx(q * s0) - last * erfcx(q * s1))
                     : std::sqrt(2.0 / (ramp.k * -ramp.g)) * (dawson(q * s0) - last * dawson(q * s1));
    return {(ramp.c0 + ramp.c1 * s0) - (ramp.c0 + ramp.c1 * s1) * last + ramp.c1 * ramp.g * clear, tau};
}

double comb_depth(const Ramp& ramp, std::span<const Tooth> teeth) {
    const double s1 = ramp.s0 + ramp.g * ramp.length;
    const double low = std::min(ramp.s0, s1);
    const double high = std::max(ramp.s0, s1);
    double inside = 0.0;
    for (const Tooth& tooth : teeth) {
        inside += std::max(0.0, std::min(tooth.high, high) - std::max(tooth.low, low));
    }
    return ramp.k * inside / std::abs(ramp.g);
}

double quadratic_maximum(const Ray& ray, const glm::dvec3& centre, const glm::dmat3& q, double peak) {
    const glm::dvec3 oc = ray.origin_mm - centre;
    const glm::dvec3& d = ray.direction;
    const double doc = glm::dot(d, q * oc);
    return peak - 0.5 * (glm::dot(oc, q * oc) - doc * doc / glm::dot(d, q * d));
}

double quadratic_maximum_loss(const Ray& ray, const glm::dmat3& q, double dt) {
    return dt * dt * glm::dot(ray.direction, q * ray.direction) / 8.0;
}

Bounds square_bias(Filter filter, double h) {
    switch (filter) {
        case Filter::trilinear:
            return {0.0, 0.75 * h * h};
        case Filter::bspline:
            return {h * h, h * h};
        default:
            return {0.0, 0.0};
    }
}

Bounds sphere_radius_bias(Filter filter, double h, double radius) {
    const Bounds bias = square_bias(filter, h);
    return {-bias.high / (2.0 * radius), -bias.low / (2.0 * radius)};
}

double marschner_lobb(const glm::dvec3& p) {
    constexpr double alpha = 0.25;
    constexpr double frequency = 6.0;
    const double r = std::hypot(p.x, p.y);
    const double ripple = std::cos(2.0 * pi * frequency * std::cos(0.5 * pi * r));
    return (1.0 - std::sin(0.5 * pi * p.z) + alpha * (1.0 + ripple)) / (2.0 * (1.0 + alpha));
}

std::vector<double> marschner_lobb_samples(int n) {
    std::vector<double> samples;
    samples.reserve(static_cast<std::size_t>(n) * static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    const double h = 2.0 / (n - 1);
    for (int z = 0; z < n; ++z) {
        for (int y = 0; y < n; ++y) {
            for (int x = 0; x < n; ++x) {
                samples.push_back(marschner_lobb({-1.0 + x * h, -1.0 + y * h, -1.0 + z * h}));
            }
        }
    }
    return samples;
}

}  // namespace viscera::reference

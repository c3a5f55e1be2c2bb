#pragma once

#include <functional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tests/reference/volume_field.h"
#include "tests/reference/volume_ray.h"

// Closed forms of line integrals and extremes, to hold shaders and integrators against. Rays are whole lines
// unless an interval is given; lengths in the ray's unit (mm).

namespace viscera::reference {

/// exp(x^2) erfc(x), relative error below 1e-14; overflows for x < -26.
[[nodiscard]] double erfcx(double x);
/// Dawson's integral exp(-x^2) int_0^x exp(t^2) dt, relative error below 1e-14.
[[nodiscard]] double dawson(double x);

/// A line relative to a point: where it comes nearest and how near.
struct Approach {
    double s = 0.0;   ///< parameter of the nearest place
    double b2 = 0.0;  ///< squared distance there, >= 0
};
[[nodiscard]] Approach approach(const Ray& ray, const glm::dvec3& centre);

// Homogeneous medium.
/// exp(-sigma L).
[[nodiscard]] double homogeneous_transmittance(double sigma, double length);
/// Opacity per length ds as one per length ds2: 1 - (1 - a)^(ds2 / ds).
[[nodiscard]] double opacity_for_step(double opacity, double ds, double ds2);

// Chords: length of the line inside. 0 where it misses.
[[nodiscard]] double sphere_chord(const Ray& ray, const glm::dvec3& centre, double radius);
/// Between two radii.
[[nodiscard]] double shell_chord(const Ray& ray, const glm::dvec3& centre, double inner, double outer);
/// Half axes along x, y, z.
[[nodiscard]] double ellipsoid_chord(const Ray& ray, const glm::dvec3& centre, const glm::dvec3& half_axes);
/// Endless cylinder along z; infinite for a ray inside along the axis.
[[nodiscard]] double cylinder_chord(const Ray& ray, const glm::dvec3& centre, double radius);
/// Convex polyhedron: the intersection of half-spaces dot(n, p) + d >= 0, closed.
[[nodiscard]] double polyhedron_chord(const Ray& ray, std::span<const glm::dvec4> half_spaces);
/// Half-spaces of the regular tetrahedron and octahedron whose faces touch the sphere (centre, radius).
[[nodiscard]] std::vector<glm::dvec4> tetrahedron(const glm::dvec3& centre, double inradius);
[[nodiscard]] std::vector<glm::dvec4> octahedron(const glm::dvec3& centre, double inradius);

// Line integrals of densities that vanish outside radius R.
/// rho = 1 - r^2 / R^2: 4/3 (R^2 - b2)^1.5 / R^2.
[[nodiscard]] double parabolic_ball(const Ray& ray, const glm::dvec3& centre, double radius);
/// rho = 1 - r / R: 2h - (h R + b2 ln((h + R) / b)) / R with h = sqrt(R^2 - b2).
[[nodiscard]] double conic_ball(const Ray& ray, const glm::dvec3& centre, double radius);
/// A exp(-r^2 / (2 sigma^2)) over a stretch of the ray.
[[nodiscard]] double gaussian_integral(const Ray& ray, const Interval& interval, const glm::dvec3& centre,
                                       double amplitude, double sigma);

/// Emission and absorption along a ramp s(t) = s0 + g t, t in [0, L]: extinction k s, colour c0 + c1 s. k > 0
/// and s >= 0 all along; any g.
struct Ramp {
    double s0 = 0.0;
    double g = 1.0;
    double length = 1.0;
    double k = 1.0;
    double c0 = 0.0;
    double c1 = 1.0;
};
struct RampLight {
    double colour = 0.0;
    double tau = 0.0;
};
[[nodiscard]] RampLight ramp_light(const Ramp& ramp);

/// A stretch of values.
struct Tooth {
    double low = 0.0;
    double high = 0.0;
};
/// tau of a ramp (k and colours as there) whose extinction is k inside disjoint teeth of values and 0
/// elsewhere; g != 0.
[[nodiscard]] double comb_depth(const Ramp& ramp, std::span<const Tooth> teeth);

/// Greatest value of peak - (x - c)' Q (x - c) / 2 along the line; Q symmetric, positive definite.
[[nodiscard]] double quadratic_maximum(const Ray& ray, const glm::dvec3& centre, const glm::dmat3& q,
                                       double peak);
/// How far below it the greatest of samples dt apart can lie: dt^2 d'Qd / 8.
[[nodiscard]] double quadratic_maximum_loss(const Ray& ray, const glm::dmat3& q, double dt);

/// Bounds of (reconstruction - f) for f = |x|^2 sampled on a grid of spacing h, away from the edge. Not for
/// nearest.
[[nodiscard]] Bounds square_bias(Filter filter, double h);
/// Bounds of (radius of the reconstructed iso-surface f = R^2 - R), to leading order in h.
[[nodiscard]] Bounds sphere_radius_bias(Filter filter, double h, double radius);

/// Test signal of Marschner and Lobb on [-1, 1]^3, alpha = 0.25, fM = 6; values in [0, 1].
[[nodiscard]] double marschner_lobb(const glm::dvec3& p);
/// It on n samples per axis, the first at -1 and the last at 1, x fastest.
[[nodiscard]] std::vector<double> marschner_lobb_samples(int n);

}  // namespace viscera::reference

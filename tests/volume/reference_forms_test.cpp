// The closed forms against integration that has converged, and the orders of the sampled schemes.

#include "tests/reference/volume_forms.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/reference/volume_exact.h"
#include "tests/reference/volume_lattice.h"

namespace viscera::reference {
namespace {

/// Box [-half, half]^3 of the world.
glm::dmat4 centred_box(double half) {
    glm::dmat4 m(2.0 * half);
    m[3] = glm::dvec4(-half, -half, -half, 1.0);
    return m;
}

Field world_field(Field::Value value, double half = 3.0) {
    return Field::in_world(std::move(value), {}, centred_box(half));
}

/// Rays through the neighbourhood of the origin, from outside of the box of half size 3.
std::vector<Ray> test_rays(int count, unsigned seed = 7) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray> rays;
    while (rays.size() < static_cast<std::size_t>(count)) {
        const glm::dvec3 d(unit(random), unit(random), unit(random));
        const glm::dvec3 p(unit(random), unit(random), unit(random));
        if (glm::length(d) > 0.1) {
            const glm::dvec3 direction = glm::normalize(d);
            rays.push_back({p - 8.0 * direction, direction});
        }
    }
    return rays;
}

/// The field's length where it is >= 1/2.
double length_inside(const Field& field, const Ray& ray) {
    const Interval interval = across(ray, field);
    double length = 0.0;
    double since = interval.begin;
    const double half = 0.5;
    for (const Crossing& c : crossings(field, ray, interval, std::span(&half, 1))) {
        if (!c.rising) {
            length += c.s_mm - since;
        }
        since = c.s_mm;
    }
    return length;
}

TEST(SpecialFunctions, HaveTheirKnownValues) {
    // Abramowitz and Stegun, table 7.1 and 7.5, and expansions to all digits.
    EXPECT_NEAR(erfcx(0.0), 1.0, 1e-15);
    EXPECT_NEAR(erfcx(1.0), 0.427583576155807004, 1e-15);
    EXPECT_NEAR(erfcx(-1.0), 5.00898008076228346, 1e-14);
    EXPECT_NEAR(erfcx(10.0), 0.0561409927438226, 1e-15);
    EXPECT_NEAR(dawson(1.0), 0.538079506912768419, 1e-15);
    EXPECT_NEAR(dawson(0.924138873), 0.5410442246, 1e-10);
    EXPECT_NEAR(dawson(10.0), 0.0502538471, 1e-9);
    EXPECT_EQ(dawson(-0.7), -dawson(0.7));
}

TEST(SpecialFunctions, SatisfyTheirDifferentialEquations) {
    // erfcx' = 2 x erfcx - 2 / sqrt(pi) and D' = 1 - 2 x D, also across the change of method at 10.
    for (double x = 0.1; x < 14.0; x += 0.0613) {
        const double h = 1e-3;
        const auto slope = [&](double (*f)(double)) {
            return (8.0 * (f(x + h) - f(x - h)) - (f(x + 2.0 * h) - f(x - 2.0 * h))) / (12.0 * h);
        };
        EXPECT_NEAR(slope(erfcx), 2.0 * x * erfcx(x) - 2.0 * std::numbers::inv_sqrtpi, 3e-11) << x;
        EXPECT_NEAR(slope(dawson), 1.0 - 2.0 * x * dawson(x), 3e-11) << x;
    }
}

TEST(ClosedForms, HomogeneousMedium) {
    const Medium medium({}, [](double) { return Emission{0.7, glm::dvec3(0.2, 0.5, 1.0)}; });
    const Field field = world_field([](const glm::dvec3&) { return 1.0; });
    const Ray ray{{-8.0, 0.3, 0.2}, {1.0, 0.0, 0.0}};
    const Light light = composite(field, ray, across(ray, field), medium);
    const double transmittance = homogeneous_transmittance(0.7, 6.0);
    EXPECT_NEAR(light.transmittance, transmittance, 1e-14);
    EXPECT_NEAR(light.colour.y, 0.5 * (1.0 - transmittance), 1e-12);
    EXPECT_NEAR(1.0 - std::pow(1.0 - opacity_for_step(0.3, 1.0, 0.25), 4.0), 0.3, 1e-15);
}

TEST(ClosedForms, ChordsAgreeWithTheRootsOfTheField) {
    const glm::dvec3 centre(0.1, -0.2, 0.05);
    const glm::dvec3 axes(1.4, 0.6, 0.9);
    const Field sphere = world_field([&](const glm::dvec3& p) { return 1.5 - glm::length(p - centre); });
    const Field ellipsoid = world_field(
        [&](const glm::dvec3& p) { return 1.5 - glm::dot((p - centre) / axes, (p - centre) / axes); });
    const Field shell = world_field([&](const glm::dvec3& p) {
        const double r2 = glm::dot(p - centre, p - centre);
        return 0.5 + (1.21 - r2) * (r2 - 0.25);
    });
    int hits = 0;
    for (const Ray& ray : test_rays(60)) {
        EXPECT_NEAR(length_inside(sphere, ray), sphere_chord(ray, centre, 1.0), 1e-9);
        EXPECT_NEAR(length_inside(ellipsoid, ray), ellipsoid_chord(ray, centre, axes), 1e-9);
        EXPECT_NEAR(length_inside(shell, ray), shell_chord(ray, centre, 0.5, 1.1), 1e-9);
        hits += sphere_chord(ray, centre, 0.5) > 0.0 ? 1 : 0;
    }
    EXPECT_GT(hits, 10);
}

TEST(ClosedForms, CylinderAndPolyhedra) {
    const glm::dvec3 centre(0.1, -0.2, 0.05);
    const Field cylinder = world_field(
        [&](const glm::dvec3& p) { return 1.5 - glm::length(glm::dvec2(p) - glm::dvec2(centre)); });
    for (const std::vector<glm::dvec4>& planes : {tetrahedron(centre, 0.6), octahedron(centre, 0.8)}) {
        const Field solid = world_field([&](const glm::dvec3& p) {
            double least = 1e300;
            for (const glm::dvec4& plane : planes) {
                least = std::min(least, glm::dot(plane, glm::dvec4(p, 1.0)));
            }
            return 0.5 + least;
        });
        for (const Ray& ray : test_rays(25)) {
            EXPECT_NEAR(length_inside(solid, ray), polyhedron_chord(ray, planes), 1e-8);
        }
    }
    const glm::dvec3 direction = glm::normalize(glm::dvec3(1.0, 0.4, 0.3));
    for (const double y : {-0.9, -0.3, 0.0, 0.55}) {
        const Ray ray{glm::dvec3(0.0, y, 0.0) - 8.0 * direction, direction};
        EXPECT_NEAR(length_inside(cylinder, ray), cylinder_chord(ray, centre, 1.0), 1e-9);
    }
    EXPECT_TRUE(std::isinf(cylinder_chord({{0.1, 0.0, 0.0}, {0.0, 0.0, 1.0}}, centre, 1.0)));
}

TEST(ClosedForms, DensityBalls) {
    const glm::dvec3 centre(0.1, -0.2, 0.05);
    const auto r = [&](const glm::dvec3& p) { return glm::length(p - centre); };
    const double radius = 1.3;
    const Field parabolic = world_field(
        [&](const glm::dvec3& p) { return std::max(0.0, 1.0 - r(p) * r(p) / (radius * radius)); });
    const Field conic = world_field([&](const glm::dvec3& p) { return std::max(0.0, 1.0 - r(p) / radius); });
    const Field gaussian =
        world_field([&](const glm::dvec3& p) { return 2.0 * std::exp(-r(p) * r(p) / (2.0 * 0.4 * 0.4)); });
    for (const Ray& ray : test_rays(40)) {
        const Interval interval = across(ray, parabolic);
        EXPECT_NEAR(line_integral(parabolic, ray, interval), parabolic_ball(ray, centre, radius), 1e-9);
        EXPECT_NEAR(line_integral(conic, ray, interval), conic_ball(ray, centre, radius), 1e-9);
        EXPECT_NEAR(line_integral(gaussian, ray, interval),
                    gaussian_integral(ray, interval, centre, 2.0, 0.4), 1e-12);
    }
}

/// Ramp along x: value s0 + g (x + 3), emission k v and c0 + c1 v.
struct RampScene {
    Ramp ramp;
    Field field;
    Medium medium;
    Ray ray{{-3.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};

    explicit RampScene(const Ramp& r)
        : ramp(r),
          field(world_field([r](const glm::dvec3& p) { return r.s0 + r.g * (p.x + 3.0); })),
          medium({}, [r](double v) {
              return Emission{r.k * v, glm::dvec3(r.c0 + r.c1 * v)};
          }) {}
    [[nodiscard]] Interval interval() const { return {0.0, ramp.length}; }
};

TEST(ClosedForms, RampOfExtinction) {
    for (const Ramp& ramp : {Ramp{0.1, 0.5, 6.0, 0.8, 0.2, 0.3}, Ramp{3.2, -0.5, 6.0, 0.8, 0.2, 0.3},
                             Ramp{0.0, 2.0, 5.0, 3.0, 0.1, 0.05}, Ramp{1.0, 1e-7, 6.0, 0.3, 0.5, 0.5},
                             Ramp{1.0, 0.0, 6.0, 0.3, 0.5, 0.5}, Ramp{1.0, -1e-7, 6.0, 0.3, 0.5, 0.5}}) {
        const RampScene scene(ramp);
        const Light light = composite(scene.field, scene.ray, scene.interval(), scene.medium);
        const RampLight exact = ramp_light(ramp);
        EXPECT_NEAR(light.colour.x, exact.colour, 1e-11) << ramp.g;
        EXPECT_NEAR(light.transmittance, std::exp(-exact.tau), 1e-11) << ramp.g;
    }
}

TEST(ClosedForms, CombOnARamp) {
    std::vector<Tooth> teeth;
    TransferFunction function;
    const double opacity = 0.4;
    for (int i = 0; i < 20; ++i) {
        teeth.push_back({0.05 * i + 0.01, 0.05 * i + 0.0271});
        for (const auto& [value, height] :
             {std::pair(teeth.back().low, 0.0), std::pair(teeth.back().low, opacity),
              std::pair(teeth.back().high, opacity), std::pair(teeth.back().high, 0.0)}) {
            function.points.push_back({value, glm::dvec3(1.0), height});
        }
    }
    const Ramp ramp{0.0131, 0.161, 6.0, -std::log1p(-opacity)};
    const RampScene scene(ramp);
    const Medium medium(function);
    const double tau = comb_depth(ramp, teeth);
    EXPECT_GT(tau, 0.5);
    EXPECT_NEAR(optical_depth(scene.field, scene.ray, scene.interval(), medium), tau, 1e-12);
    EXPECT_NEAR(composite(scene.field, scene.ray, scene.interval(), medium).colour.x, -std::expm1(-tau),
                1e-11);
    // Pre-integration is exact on a ramp, whatever the step; the same samples without it are not.
    LatticeOptions options{.scheme = Scheme::preintegrated};
    EXPECT_NEAR(composite_on_lattice(scene.field, scene.ray, scene.interval(), 0.7, medium, options).alpha(),
                -std::expm1(-tau), 1e-11);
    options.scheme = Scheme::midpoint;
    EXPECT_GT(
        std::abs(
            composite_on_lattice(scene.field, scene.ray, scene.interval(), 0.7, medium, options).alpha() +
            std::expm1(-tau)),
        1e-3);
}

TEST(ClosedForms, MaximumOfAQuadratic) {
    const glm::dvec3 centre(0.1, -0.2, 0.05);
    const glm::dmat3 q(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, 1.5);
    const Field field = world_field(
        [&](const glm::dvec3& p) { return 4.0 - 0.5 * glm::dot(p - centre, q * (p - centre)); }, 5.0);
    const double dt = 0.37;
    for (const Ray& ray : test_rays(30)) {
        const double exact = quadratic_maximum(ray, centre, q, 4.0);
        const Interval interval = across(ray, field);
        EXPECT_NEAR(maximum(field, ray, interval).value_or(0.0), exact, 1e-12);
        const double sampled = maximum_on_lattice(field, ray, interval, dt).value_or(0.0);
        EXPECT_LE(sampled, exact + 1e-12);
        EXPECT_GE(sampled, exact - quadratic_maximum_loss(ray, q, dt) - 1e-12);
    }
}

/// Slope of log error over log step between n and 2 n samples.
template <class Error>
double order(const Error& error, int n) {
    return std::log2(error(n) / error(2 * n));
}

TEST(Orders, OnARamp) {
    const RampScene scene({0.1, 0.5, 6.0, 0.8, 0.2, 0.3});
    const double exact = ramp_light(scene.ramp).colour;
    const auto error_of = [&](Scheme scheme) {
        return [&, scheme](int n) {
            return std::abs(composite_on_lattice(scene.field, scene.ray, scene.interval(),
                                                 scene.ramp.length / n, scene.medium, {.scheme = scheme})
                                .colour.x -
                            exact);
        };
    };
    for (const int n : {16, 32, 64}) {
        EXPECT_NEAR(order(error_of(Scheme::midpoint), n), 2.0, 0.05) << n;
        EXPECT_GE(order(error_of(Scheme::fourth_order), n), 3.8) << n;
    }
    EXPECT_LE(error_of(Scheme::fourth_order)(64), 2e-6);
}

TEST(Orders, OnAGaussianAlongAnyRay) {
    const double sigma = 0.8;
    const Field field =
        world_field([&](const glm::dvec3& p) { return std::exp(-glm::dot(p, p) / (2.0 * sigma * sigma)); });
    const Medium medium({}, [](double v) { return Emission{1.3 * v, glm::dvec3(0.3 + 0.6 * v)}; });
    for (const Ray& ray : test_rays(6)) {
        // A stretch that ends inside the bell, so that no symmetry makes the rule better than it is.
        const Approach near = approach(ray, glm::dvec3(0.0));
        const Interval interval{near.s - 1.7, near.s + 0.4};
        const double exact = composite(field, ray, interval, medium, {.tolerance = 1e-15}).colour.x;
        const auto error_of = [&](Scheme scheme) {
            return [&, scheme](int n) {
                return std::abs(composite_on_lattice(field, ray, interval, interval.length() / n, medium,
                                                     {.scheme = scheme})
                                    .colour.x -
                                exact);
            };
        };
        for (const int n : {16, 32}) {
            EXPECT_NEAR(order(error_of(Scheme::midpoint), n), 2.0, 0.05) << n;
            EXPECT_GE(order(error_of(Scheme::fourth_order), n), 3.8) << n;
        }
        const double depth = 1.3 * gaussian_integral(ray, interval, glm::dvec3(0.0), 1.0, sigma);
        EXPECT_NEAR(composite(field, ray, interval, medium).transmittance, std::exp(-depth), 1e-11);
    }
}

}  // namespace
}  // namespace viscera::reference

// Ray functions of the reference against brute force, and what must not change them.

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <glm/ext/matrix_transform.hpp>

#include "tests/reference/volume_exact.h"
#include "tests/reference/volume_lattice.h"

namespace viscera::reference {
namespace {

const glm::ivec3 noise_dims(9, 7, 8);

std::vector<double> noise(unsigned seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<double> samples(9 * 7 * 8);
    for (double& sample : samples) {
        sample = unit(random);
    }
    return samples;
}

/// White noise in an anisotropic, sheared box about the origin.
Field noise_field(Filter filter, unsigned seed = 1) {
    glm::dmat4 to_world = glm::scale(glm::dmat4(1.0), {9.0, 5.0, 6.0});
    to_world[1][0] = 1.0;
    to_world[3] = glm::dvec4(-5.0, -2.5, -3.0, 1.0);
    return {noise_dims, noise(seed), filter, to_world};
}

std::vector<Ray> rays_through_noise(int count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {
        const glm::dvec3 direction =
            glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)) + 1e-3);
        rays.push_back(
            {2.0 * glm::dvec3(unit(random), unit(random), unit(random)) - 20.0 * direction, direction});
    }
    return rays;
}

TransferFunction smooth_function() {
    TransferFunction f;
    f.points = {{0.2, {1.0, 0.0, 0.2}, 0.0},
                {0.5, {0.1, 0.9, 0.2}, 0.3},
                {0.6, {0.4, 0.2, 0.8}, 0.1},
                {0.9, {0.9, 0.9, 0.3}, 0.8}};
    f.reference_length_mm = 0.7;
    return f;
}

/// With a step, a thin spike and full opacity.
TransferFunction rough_function() {
    TransferFunction f;
    f.points = {{0.3, {1.0, 0.0, 0.2}, 0.0}, {0.3, {0.0, 1.0, 0.2}, 0.2},    {0.4, {0.1, 0.9, 0.2}, 0.0},
                {0.5, {0.5, 0.2, 0.2}, 0.0}, {0.5005, {1.0, 1.0, 1.0}, 0.9}, {0.501, {0.5, 0.2, 0.2}, 0.0},
                {0.8, {0.4, 0.2, 0.8}, 0.0}, {0.95, {0.9, 0.9, 0.3}, 1.0}};
    return f;
}

TEST(ExactRays, XrayOfVoxelsIsExact) {
    // Two Gauss points between the crossings of all faces are exact on a trilinear field, so cutting the ray
    // differently must not matter; and the sum of many samples tends to the same.
    // Zero is at value -1, which no filter's overshoot reaches here, so that mu is linear throughout.
    const Medium mu = Medium::attenuation(0.4, 0.4);
    for (const Filter filter : all_filters) {
        const Field field = noise_field(filter);
        for (const Ray& ray : rays_through_noise(12)) {
            const Interval interval = across(ray, field);
            if (interval.length() < 0.1) {
                continue;
            }
            const double depth = optical_depth(field, ray, interval, mu);
            const double middle = interval.begin + 0.37 * interval.length();
            EXPECT_NEAR(depth,
                        optical_depth(field, ray, {interval.begin, middle}, mu) +
                            optical_depth(field, ray, {middle, interval.end}, mu),
                        1e-14 * depth);
            EXPECT_NEAR(depth, 0.4 * (line_integral(field, ray, interval) + interval.length()),
                        1e-13 * depth);
            EXPECT_NEAR(xray_on_lattice(field, ray, interval, interval.length() / 20000, mu),
                        std::exp(-depth), filter == Filter::nearest ? 2e-4 : 2e-8);
        }
    }
}

TEST(ExactRays, AttenuationIsNeverNegative) {
    const Field ramp = Field::in_world([](const glm::dvec3& p) { return p.x; }, {},
                                       glm::scale(glm::dmat4(1.0), glm::dvec3(2000.0)));
    const Ray ray{{0.0, 5.0, 5.0}, {1.0, 0.0, 0.0}};
    const Field hounsfield = ramp.moved(glm::translate(glm::dmat4(1.0), {0.0, 0.0, 0.0}));
    // HU = x - 1500 over [0, 2000]: air below -1000, that is up to 500; then a ramp up to 1.5 mu_water.
    const Medium shifted({500.0}, [](double x) { return ct_attenuation(0.002).at(x - 1500.0); });
    EXPECT_NEAR(optical_depth(hounsfield, ray, {0.0, 2000.0}, shifted), 0.5 * 1500.0 * 1.5 * 0.002, 1e-12);
    EXPECT_NEAR(ct_attenuation(0.02).at(0.0).extinction, 0.02, 1e-17);
    EXPECT_EQ(ct_attenuation(0.02).at(-1024.0).extinction, 0.0);
}

TEST(ExactRays, CompositeIsTheLimitOfItsSamples) {
    const Medium smooth(smooth_function());
    const Medium rough(rough_function());
    for (const Filter filter : all_filters) {
        const Field field = noise_field(filter);
        // Sums of |samples - exact| at a step and at a quarter of it.
        glm::dvec2 smooth_error(0.0);
        glm::dvec2 rough_error(0.0);
        for (const Ray& ray : rays_through_noise(6)) {
            const Interval interval = across(ray, field);
            if (interval.length() < 0.1) {
                continue;
            }
            const auto error = [&](const Medium& medium, Scheme scheme, int n) {
                return glm::length(composite(field, ray, interval, medium).rgba() -
                                   composite_on_lattice(field, ray, interval, interval.length() / n, medium,
                                                        {.scheme = scheme})
                                       .rgba());
            };
            smooth_error +=
                glm::dvec2(error(smooth, Scheme::midpoint, 2500), error(smooth, Scheme::midpoint, 10000));
            rough_error += glm::dvec2(error(rough, Scheme::preintegrated, 750),
                                      error(rough, Scheme::preintegrated, 3000));
        }
        if (filter == Filter::nearest) {  // the field's own jumps, to first order
            EXPECT_LT(smooth_error[1], 6 * 1e-3);
            EXPECT_LT(rough_error[1], 6 * 5e-3);
        } else {  // sixteen times less at order 2, and it could not be if the limit were another
            EXPECT_GT(smooth_error[0] / smooth_error[1], 12.0);
            EXPECT_GT(rough_error[0] / rough_error[1], 12.0);
            EXPECT_LT(smooth_error[1], 6 * 4e-7);
            EXPECT_LT(rough_error[1], 6 * 4e-5);
        }
    }
}

TEST(ExactRays, ToleranceIsKept) {
    for (const Filter filter : {Filter::trilinear, Filter::bspline_prefiltered}) {
        const Field field = noise_field(filter, 3);
        for (const TransferFunction& function : {smooth_function(), rough_function()}) {
            const Medium medium(function);
            for (const Ray& ray : rays_through_noise(20)) {
                const Interval interval = across(ray, field);
                const auto at = [&](double tolerance) {
                    return composite(field, ray, interval, medium, {tolerance, 0.0}).rgba();
                };
                const glm::dvec4 best = at(1e-17);
                EXPECT_LE(glm::length(at(1e-11) - best), 1e-11);
                EXPECT_LE(glm::length(at(1e-7) - best), 1e-7);
                EXPECT_LE(glm::length(at(1e-4) - best), 1e-4);
            }
        }
    }
}

TEST(ExactRays, ExtremesAndMeanAgainstDenseSampling) {
    for (const Filter filter : all_filters) {
        const Field field = noise_field(filter, 5);
        for (const Ray& ray : rays_through_noise(12)) {
            const Interval interval = across(ray, field);
            if (interval.length() < 0.1) {
                continue;
            }
            const double ds = interval.length() / 5000;
            const double limit = filter == Filter::nearest ? 0.0 : 1e-6;
            const double high = maximum(field, ray, interval).value();
            const double low = minimum(field, ray, interval).value();
            const double high_seen = maximum_on_lattice(field, ray, interval, ds).value();
            const double low_seen = minimum_on_lattice(field, ray, interval, ds).value();
            EXPECT_GE(high - high_seen, -1e-14);
            EXPECT_LE(low - low_seen, 1e-14);
            if (filter != Filter::nearest) {  // a corner's cell may be thinner than a step
                EXPECT_LE(high - high_seen, limit + 3.0 * ds);
                EXPECT_LE(low_seen - low, limit + 3.0 * ds);
            }
            EXPECT_NEAR(mean(field, ray, interval).value(), mean_on_lattice(field, ray, interval, ds).value(),
                        filter == Filter::nearest ? 4e-3 : 0.1 * ds * ds);
            EXPECT_NEAR(mean(field, ray, interval, 0.4).value_or(-1.0),
                        mean_on_lattice(field, ray, interval, ds, 0.4).value_or(-1.0), 4e-3);
            EXPECT_FALSE(maximum(field, ray, interval, high + 1e-9));
            EXPECT_TRUE(maximum(field, ray, interval, high));
            EXPECT_GE(minimum(field, ray, interval, 0.5).value_or(0.5), 0.5);
        }
    }
}

TEST(ExactRays, NoCrossingIsMissed) {
    for (const Filter filter : all_filters) {
        const Field field = noise_field(filter, 7);
        std::size_t total = 0;
        for (const Ray& ray : rays_through_noise(40)) {
            const Interval interval = across(ray, field);
            if (interval.length() < 0.1) {
                continue;
            }
            const std::vector<double> isos{0.45, 0.6};
            const std::vector<Crossing> all = crossings(field, ray, interval, isos);
            EXPECT_TRUE(std::ranges::is_sorted(all, {}, &Crossing::s_mm));
            total += all.size();
            for (const double iso : isos) {
                std::vector<Crossing> own;
                std::ranges::copy_if(all, std::back_inserter(own),
                                     [&](const Crossing& c) { return c.iso == iso; });
                // Dense samples change side exactly as often as there are crossings between them, mod 2.
                const int n = 3000;
                std::size_t next = 0;
                bool inside = value_at(field, ray, interval.begin) >= iso;
                for (int i = 1; i < n; ++i) {
                    const double s = interval.begin + interval.length() * (i + 0.123) / n;
                    const bool now = value_at(field, ray, s) >= iso;
                    bool told = inside;
                    for (; next < own.size() && own[next].s_mm < s; ++next) {
                        told = !told;
                        EXPECT_EQ(own[next].rising, told);
                    }
                    EXPECT_EQ(told, now);
                    inside = now;
                }
                const std::optional<Crossing> first = first_crossing(field, ray, interval, iso);
                ASSERT_EQ(first.has_value(), !own.empty());
                if (first) {
                    EXPECT_EQ(first->s_mm, own.front().s_mm);
                }
                for (const Crossing& c : own) {
                    if (filter != Filter::nearest) {
                        EXPECT_NEAR(field.value(c.texture), iso, 1e-13);
                        EXPECT_NEAR(glm::length(c.normal), 1.0, 1e-14);
                        EXPECT_LE(glm::dot(c.normal, ray.direction) * (c.rising ? 1.0 : -1.0), 1e-6);
                    }
                }
            }
        }
        EXPECT_GT(total, 100U);
    }
}

TEST(ExactRays, SurfacesOnPlateausAndAtTheEye) {
    const Field flat(glm::ivec3(3), std::vector<double>(27, 0.5), Filter::trilinear);
    const Ray ray{{-1.0, 0.4, 0.6}, {1.0, 0.0, 0.0}};
    EXPECT_FALSE(first_crossing(flat, ray, {1.0, 2.0}, 0.5));
    EXPECT_FALSE(first_crossing(flat, ray, {1.0, 2.0}, 0.6));
    std::vector<double> wall(27, 0.0);
    for (std::size_t i = 0; i < 27; i += 3) {
        wall[i] = 1.0;
        wall[i + 1] = 1.0;
    }
    const Field step(glm::ivec3(3), wall, Filter::trilinear);
    const std::optional<Crossing> leaving = first_crossing(step, ray, {1.0, 2.0}, 0.25);
    ASSERT_TRUE(leaving);
    EXPECT_NEAR(leaving->s_mm, 1.0 + (1.5 + 0.75) / 3.0, 1e-15);
    EXPECT_FALSE(leaving->rising);
    EXPECT_NEAR(leaving->normal.x, 1.0, 1e-15);
    // At iso 1 the plateau is inside, and its end is the surface.
    EXPECT_NEAR(first_crossing(step, ray, {1.0, 2.0}, 1.0)->s_mm, 1.5, 1e-12);
}

TEST(ExactRays, LengthsTimesAPowerOfTwoChangeNoBit) {
    for (const Filter filter : all_filters) {
        const Field field = noise_field(filter);
        TransferFunction function = smooth_function();
        const Medium medium(function);
        for (const double scale : {1024.0, 1.0 / 4096.0}) {
            const Field scaled = field.moved(glm::scale(glm::dmat4(1.0), glm::dvec3(scale)));
            TransferFunction stretched = function;
            stretched.reference_length_mm *= scale;
            const Medium scaled_medium(stretched);
            for (const Ray& ray : rays_through_noise(10)) {
                const Ray far{ray.origin_mm * scale, ray.direction};
                const Interval a = across(ray, field);
                const Interval b = across(far, scaled);
                EXPECT_EQ(composite(field, ray, a, medium).rgba(),
                          composite(scaled, far, b, scaled_medium).rgba());
                EXPECT_EQ(maximum(field, ray, a), maximum(scaled, far, b));
                const auto one = first_crossing(field, ray, a, 0.5);
                const auto two = first_crossing(scaled, far, b, 0.5);
                ASSERT_EQ(one.has_value(), two.has_value());
                if (one) {
                    EXPECT_EQ(one->s_mm * scale, two->s_mm);
                }
            }
        }
    }
}

TEST(ExactRays, AMirroredVolumeInAMirroredBoxIsTheSame) {
    std::vector<double> reversed = noise();
    for (auto row = reversed.begin(); row != reversed.end(); row += noise_dims.x) {
        std::reverse(row, row + noise_dims.x);
    }
    glm::dmat4 flip(1.0);
    flip[0][0] = -1.0;
    flip[3][0] = 1.0;
    const Medium medium(smooth_function());
    for (const Filter filter : all_filters) {
        const Field field = noise_field(filter);
        const Field mirrored(noise_dims, reversed, filter, field.texture_to_world() * flip);
        for (const Ray& ray : rays_through_noise(10)) {
            const Interval interval = across(ray, field);
            EXPECT_LE(glm::length(composite(field, ray, interval, medium).rgba() -
                                  composite(mirrored, ray, interval, medium).rgba()),
                      1e-11);
            const auto one = first_crossing(field, ray, interval, 0.5);
            const auto two = first_crossing(mirrored, ray, interval, 0.5);
            ASSERT_EQ(one.has_value(), two.has_value());
            if (one) {
                EXPECT_NEAR(one->s_mm, two->s_mm, 1e-10);
                EXPECT_LE(glm::length(one->normal - two->normal), 1e-8);
            }
        }
    }
}

TEST(Lattice, SlabsCoverTheRay) {
    const std::vector<Slab> whole = slabs({2.0, 4.0}, 0.5);
    ASSERT_EQ(whole.size(), 4U);
    EXPECT_DOUBLE_EQ(whole[2].sample, 3.25);
    const std::vector<Slab> rest = slabs({2.0, 3.2}, 0.5);
    ASSERT_EQ(rest.size(), 3U);
    EXPECT_DOUBLE_EQ(rest[2].begin, 3.0);
    EXPECT_DOUBLE_EQ(rest[2].sample, 3.1);
    EXPECT_DOUBLE_EQ(rest[2].end, 3.2);
    EXPECT_EQ(slabs({2.0, 2.1}, 0.5).size(), 1U);
    EXPECT_EQ(slabs({2.0, 2.0 + 0.1 * 7}, 0.1).size(), 7U);
}

TEST(Lattice, OpacityDoesNotDependOnTheStep) {
    const Field flat(glm::ivec3(2), std::vector<double>(8, 0.55), Filter::trilinear,
                     glm::scale(glm::dmat4(1.0), glm::dvec3(10.0)));
    const Ray ray{{-1.0, 4.0, 6.0}, {1.0, 0.0, 0.0}};
    const Interval interval = across(ray, flat);
    const Medium medium(smooth_function());
    const double alpha = 1.0 - std::pow(1.0 - 0.2, 10.0 / 0.7);
    for (const Scheme scheme : {Scheme::midpoint, Scheme::preintegrated, Scheme::fourth_order}) {
        // fourth_order's light is as exact as its rule: order 4 in kappa h.
        for (const double ds : {0.03, 0.0123}) {
            const Light light = composite_on_lattice(flat, ray, interval, ds, medium, {.scheme = scheme});
            EXPECT_NEAR(light.alpha(), alpha, 1e-12);
            EXPECT_NEAR(light.colour.x, 0.25 * alpha, scheme == Scheme::fourth_order ? 1e-9 : 1e-12);
        }
    }
    EXPECT_NEAR(composite(flat, ray, interval, medium).alpha(), alpha, 1e-12);
}

TEST(Lattice, IsoShadeAndEarlyStop) {
    const Field field = noise_field(Filter::trilinear);
    const Medium medium(smooth_function());
    const Ray ray = rays_through_noise(1).front();
    const Interval interval = across(ray, field);
    const double all = composite_on_lattice(field, ray, interval, 0.05, medium).alpha();
    const double some = composite_on_lattice(field, ray, interval, 0.05, medium, {.iso = 0.5}).alpha();
    EXPECT_LT(some, all);
    EXPECT_GT(some, 0.0);
    const double stopped =
        composite_on_lattice(field, ray, interval, 0.05, medium, {.stop_alpha = 0.5 * all}).alpha();
    EXPECT_GT(stopped, 0.5 * all);
    EXPECT_LT(stopped, all);
    LatticeOptions dark;
    dark.shade = [](const Emission& e, double, const glm::dvec3&, const Ray&) {
        return Emission{e.extinction, 0.5 * e.colour};
    };
    EXPECT_NEAR(composite_on_lattice(field, ray, interval, 0.05, medium, dark).colour.y,
                0.5 * composite_on_lattice(field, ray, interval, 0.05, medium).colour.y, 1e-15);
}

TEST(Lattice, FindsTheCrossingBetweenItsSamples) {
    const Field field = noise_field(Filter::catmull_rom);
    for (const Ray& ray : rays_through_noise(30)) {
        const Interval interval = across(ray, field);
        if (interval.length() < 0.1) {
            continue;
        }
        const auto fine = crossing_on_lattice(field, ray, interval, 0.003, 0.5);
        const auto exact = first_crossing(field, ray, interval, 0.5);
        if (fine && exact->s_mm > interval.begin + 0.003) {
            EXPECT_NEAR(fine->s_mm, exact->s_mm, 1e-12);
            EXPECT_EQ(fine->rising, exact->rising);
        }
    }
}

TEST(Lattice, AccumulateAndDensityOfAConstant) {
    const glm::dmat4 box = glm::scale(glm::dmat4(1.0), glm::dvec3(10.0));
    const auto constant = [&](double value) {
        return Field(glm::ivec3(2), std::vector<double>(8, value), Filter::trilinear, box);
    };
    const Ray ray{{-1.0, 4.0, 6.0}, {1.0, 0.0, 0.0}};
    const Interval interval{1.0, 11.0};
    Accumulate rule{.opacity = 0.6, .samples = 50.0, .brightness = 0.1, .contrast = 2.0};
    const std::vector<Field> grey{constant(0.5)};
    const double alpha = 1.0 - std::pow(1.0 - 0.5 * 0.6 / 50.0, 50.0);
    EXPECT_NEAR(accumulate(grey, ray, interval, 0.2, rule).a, alpha, 1e-13);
    EXPECT_NEAR(accumulate(grey, ray, interval, 0.2, rule).r, (0.5 + 0.1) * 2.0 * alpha, 1e-13);
    const std::vector<Field> rgba{constant(0.2), constant(0.3), constant(0.4), constant(0.5)};
    EXPECT_NEAR(accumulate(rgba, ray, interval, 0.2, rule).b, (0.4 + 0.1) * 2.0 * alpha, 1e-13);
    rule.high.g = 0.29;
    EXPECT_EQ(accumulate(rgba, ray, interval, 0.2, rule), glm::dvec4(0.0));

    const Density density_rule{.density = 0.05, .reference_length_mm = 0.5, .scale = 2.0, .brightness = 1.5};
    const glm::dvec4 seen = density(constant(0.25), ray, interval, 0.13, smooth_function(), density_rule);
    const double opaque = 1.0 - std::pow(0.95, 20.0);
    EXPECT_NEAR(seen.a, opaque, 1e-12);
    EXPECT_NEAR(seen.g, 1.5 * 0.9 * opaque, 1e-12);
    EXPECT_EQ(density(constant(0.05), ray, interval, 0.13, smooth_function(), density_rule).a, 0.0);
}

TEST(Media, FollowTheTransferFunction) {
    const Medium medium(rough_function());
    EXPECT_EQ(medium.at(0.2999).extinction, 0.0);
    EXPECT_NEAR(medium.at(0.3).extinction, -std::log1p(-0.2), 1e-15);
    EXPECT_NEAR(medium.at(0.35).extinction, -std::log1p(-0.1), 1e-14);
    EXPECT_NEAR(medium.at(0.35).colour.r, 0.05, 1e-14);
    EXPECT_NEAR(medium.at(2.0).extinction, 24.0 * std::log(2.0), 1e-12);
    EXPECT_EQ(medium.at(std::nan("")).extinction, 0.0);
    EXPECT_EQ(Medium(TransferFunction{}).at(1.0).extinction, 0.0);
    TransferFunction function;
    function.gradient = {{1.0, 0.0}, {3.0, 1.0}};
    EXPECT_EQ(gradient_factor(function, 0.5), 0.0);
    EXPECT_EQ(gradient_factor(function, 1.5), 0.25);
    EXPECT_EQ(gradient_factor(function, 9.0), 1.0);
}

}  // namespace
}  // namespace viscera::reference

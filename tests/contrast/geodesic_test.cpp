#include "effects/contrast/geodesic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "effects/contrast/density.h"
#include "engine/core/error.h"

namespace viscera::contrast {
namespace {

using std::numbers::pi;

struct Surface {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
};

void add_grid_triangles(Surface& s, std::uint32_t rows, std::uint32_t columns, std::uint32_t first) {
    for (std::uint32_t r = 0; r + 1 < rows; ++r) {
        for (std::uint32_t c = 0; c + 1 < columns; ++c) {
            const std::uint32_t i = first + r * columns + c;
            s.indices.insert(s.indices.end(), {i, i + 1, i + columns, i + 1, i + columns + 1, i + columns});
        }
    }
}

// A square of side 100 in z = 0, its inner vertices moved about as far as no triangle turns over.
Surface rough_square(std::uint32_t n, double roughness) {
    Surface s;
    std::mt19937 random(9);
    std::uniform_real_distribution<double> shift(-roughness, roughness);
    for (std::uint32_t r = 0; r <= n; ++r) {
        for (std::uint32_t c = 0; c <= n; ++c) {
            const bool inner = r > 0 && c > 0 && r < n && c < n;
            s.positions.emplace_back(100.0 * (c + (inner ? shift(random) : 0.0)) / n,
                                     100.0 * (r + (inner ? shift(random) : 0.0)) / n, 0.0);
        }
    }
    add_grid_triangles(s, n + 1, n + 1, 0);
    return s;
}

// Side of a cylinder of radius 10 about z, open at both ends; a seam of double vertices.
Surface cylinder(std::uint32_t around, std::uint32_t along, double length,
                 glm::dvec3 base = glm::dvec3(0.0)) {
    Surface s;
    for (std::uint32_t r = 0; r <= along; ++r) {
        for (std::uint32_t c = 0; c <= around; ++c) {
            const double angle = c == around ? 0.0 : 2.0 * pi * c / around;
            s.positions.emplace_back(
                base + glm::dvec3(10.0 * std::cos(angle), 10.0 * std::sin(angle), length * r / along));
        }
    }
    add_grid_triangles(s, along + 1, around + 1, 0);
    return s;
}

void append(Surface& s, const Surface& other) {
    const auto first = static_cast<std::uint32_t>(s.positions.size());
    s.positions.insert(s.positions.end(), other.positions.begin(), other.positions.end());
    for (const std::uint32_t i : other.indices) {
        s.indices.push_back(first + i);
    }
}

Surface sphere(std::uint32_t rows, std::uint32_t columns) {
    Surface s;
    for (std::uint32_t r = 0; r <= rows; ++r) {
        for (std::uint32_t c = 0; c <= columns; ++c) {
            const double theta = pi * r / rows;
            const double phi = c == columns ? 0.0 : 2.0 * pi * c / columns;
            const double ring = r == 0 || r == rows ? 0.0 : 30.0 * std::sin(theta);
            s.positions.emplace_back(ring * std::cos(phi), ring * std::sin(phi), 30.0 * std::cos(theta));
        }
    }
    add_grid_triangles(s, rows + 1, columns + 1, 0);
    return s;
}

TEST(Geodesic, IsExactOnAPlane) {
    const Surface s = rough_square(60, 0.24);
    Log log;
    for (const glm::dvec3 from : {glm::dvec3(0, 0, 0), glm::dvec3(50, 50, 0)}) {
        const GeodesicDistances d = geodesic_distances(s.positions, s.indices, from, 0.0, log);
        double worst = 0.0;
        for (std::size_t v = 0; v < s.positions.size(); ++v) {
            const double exact = glm::distance(glm::dvec3(s.positions[v]), glm::dvec3(s.positions[d.start]));
            worst = std::max(worst, std::abs(d.distance_mm[v] - exact));
        }
        std::printf("plane: worst error %.2g of 100 mm\n", worst);
        EXPECT_LT(worst, 1.0e-5);
    }
    EXPECT_TRUE(log.faults().empty());
}

TEST(Geodesic, FollowsTheHelixOnACylinder) {
    const Surface s = cylinder(64, 60, 80.0);
    Log log;
    const GeodesicDistances d = geodesic_distances(s.positions, s.indices, {10, 0, 0}, 0.0, log);
    double worst = 0.0;
    double largest = 0.0;
    for (std::size_t v = 0; v < s.positions.size(); ++v) {
        const glm::dvec3 p(s.positions[v]);
        const double exact = std::hypot(10.0 * std::abs(std::atan2(p.y, p.x)), p.z);
        worst = std::max(worst, std::abs(d.distance_mm[v] - exact));
        largest = std::max(largest, exact);
    }
    std::printf("cylinder: worst error %.3f %% of %.1f mm\n", 100 * worst / largest, largest);
    EXPECT_LT(worst, 0.002 * largest);
    EXPECT_EQ(d.parts, 1U);
    EXPECT_EQ(d.vertices_reached, s.positions.size());
}

double worst_on_sphere(const Surface& s, const glm::dvec3& from) {
    Log log;
    const GeodesicDistances d = geodesic_distances(s.positions, s.indices, from, 0.0, log);
    double worst = 0.0;
    for (std::size_t v = 0; v < s.positions.size(); ++v) {
        const double cosine = glm::dot(glm::dvec3(s.positions[v]), from) / 900.0;
        worst = std::max(worst, std::abs(d.distance_mm[v] - 30.0 * std::acos(std::clamp(cosine, -1.0, 1.0))));
    }
    std::printf("sphere of %zu vertices: worst error %.3f %%\n", s.positions.size(), 100 * worst / (30 * pi));
    return worst / (30.0 * pi);
}

// From the equator the ways lead over the slivers at the poles. The error is largest at the antipode, where
// all ways meet, and of first order.
TEST(Geodesic, FollowsGreatCirclesOnASphere) {
    EXPECT_LT(worst_on_sphere(sphere(72, 72), {0, 0, 30}), 0.001);
    const double coarse = worst_on_sphere(sphere(36, 36), {30, 0, 0});
    const double fine = worst_on_sphere(sphere(72, 72), {30, 0, 0});
    EXPECT_LT(fine, 0.02);
    EXPECT_LT(fine, 0.65 * coarse);
}

TEST(Geodesic, BridgesGapsNoWiderThanToldTo) {
    Surface s = cylinder(32, 30, 40.0);
    append(s, cylinder(32, 30, 40.0, {0, 0, 40.5}));
    append(s, cylinder(32, 30, 40.0, {0, 0, 83.0}));
    Log log;
    const glm::dvec3 from(10, 0, 0);
    EXPECT_EQ(geodesic_distances(s.positions, s.indices, from, 0.0, log).parts_reached, 1U);
    EXPECT_EQ(geodesic_distances(s.positions, s.indices, from, 0.4, log).parts_reached, 1U);
    const GeodesicDistances one = geodesic_distances(s.positions, s.indices, from, 1.0, log);
    EXPECT_EQ(one.parts, 3U);
    EXPECT_EQ(one.parts_reached, 2U);
    // Straight up the line x = 10: 40 mm, the gap, and 40 mm again.
    EXPECT_NEAR(one.distance_mm[2 * 33 * 31 - 33], 80.5, 1e-4);
    const GeodesicDistances all = geodesic_distances(s.positions, s.indices, from, 2.6, log);
    EXPECT_EQ(all.parts_reached, 3U);
    EXPECT_NEAR(all.distance_mm[3 * 33 * 31 - 33], 123.0, 1e-4);

    const std::vector<float> arrival =
        geodesic_arrival(s.positions, s.indices, from, {.speed_mm_s = 20.0, .bridge_mm = 1.0}, log);
    EXPECT_NEAR(static_cast<double>(arrival[2 * 33 * 31 - 33]), 80.5 / 20.0, 1e-5);
    EXPECT_EQ(arrival.back(), unreached_s);
    EXPECT_EQ(log.faults().at("contrast.unreached_parts"), 1U);
}

TEST(Geodesic, BadMeshesStayFiniteAndSaySo) {
    Log log;
    const glm::dvec3 origin(0.0);
    EXPECT_EQ(geodesic_distances({}, {}, origin, 1.0, log).vertices_reached, 0U);
    EXPECT_EQ(log.faults().at("contrast.no_injection_vertex"), 1U);

    // Vertices without triangles, indices out of range, a triangle without area, and one without a number.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0}, {2, 0, 0},
                                           {0, 1, 0}, {9, 9, 9}, {nan, 0, 0}};
    const std::vector<std::uint32_t> indices{0, 1, 2, 0, 1, 3, 0, 1, 77, 0, 1, 5, 0, 0, 1};
    const GeodesicDistances d = geodesic_distances(positions, indices, origin, 5.0, log);
    EXPECT_EQ(log.faults().at("contrast.mesh_index"), 2U);
    EXPECT_NEAR(d.distance_mm[2], 2.0, 1e-12);
    EXPECT_NEAR(d.distance_mm[3], 1.0, 1e-12);
    EXPECT_TRUE(std::isinf(d.distance_mm[4]));
    EXPECT_TRUE(std::isinf(d.distance_mm[5]));

    const double dnan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(geodesic_distances(positions, indices, glm::dvec3(dnan), 5.0, log).vertices_reached, 0U);
    for (const GeodesicParams& params :
         {GeodesicParams{.speed_mm_s = 0.0}, GeodesicParams{.speed_mm_s = dnan},
          GeodesicParams{.bridge_mm = -1.0}, GeodesicParams{.bridge_mm = dnan}}) {
        EXPECT_THROW((void)geodesic_arrival(positions, indices, origin, params, log), Error);
    }
}

}  // namespace
}  // namespace viscera::contrast

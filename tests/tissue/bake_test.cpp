#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/core/placement.h"
#include "engine/io/mesh.h"
#include "tests/tissue/bake_stage.h"

// tissue.bake against closed forms and against a brute-force bake in double precision.
namespace viscera::test {
namespace {

using std::numbers::pi;

/// What deviates most, over all texels inside charts.
struct Worst {
    double position_ulps = 0.0;  ///< of the largest coordinate of the surface
    double normal = 0.0;         ///< length of the difference
    double step = 0.0;           ///< relative, of both texel steps
    double cosine = 0.0;
    double area = 0.0;  ///< relative
    int texels = 0;
    int missing = 0;  ///< texels whose centre lies in a triangle, but which are not marked so
    int surplus = 0;
};

Worst against_reference(const Baked& baked, const reference::BakedSurface& surface) {
    double size = 0.0;
    for (const glm::dvec3& p : surface.positions) {
        size = std::max({size, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    const glm::dvec2 texels(baked.width, baked.height);
    Worst worst;
    for (int y = 0; y < baked.height; ++y) {
        for (int x = 0; x < baked.width; ++x) {
            const auto all = reference::baked_points(surface, baked.uv(x, y), texels);
            worst.missing += !all.empty() && !baked.inside(x, y) ? 1 : 0;
            worst.surplus += all.empty() && baked.inside(x, y) ? 1 : 0;
            // On an edge either triangle is right.
            if (all.size() != 1 || all[0].margin < 1e-6 || !baked.inside(x, y)) {
                continue;
            }
            const reference::BakedPoint& p = all[0];
            ++worst.texels;
            const glm::dvec3 place(baked.at(baked.position, x, y));
            for (int c = 0; c < 3; ++c) {
                worst.position_ulps = std::max(worst.position_ulps, ulps(place[c] - p.position[c], size));
            }
            worst.normal =
                std::max(worst.normal, glm::length(glm::dvec3(baked.at(baked.normal, x, y)) - p.normal));
            const glm::dvec4 metric(baked.at(baked.metric, x, y));
            const double du = glm::length(p.du);
            const double dv = glm::length(p.dv);
            worst.step = std::max({worst.step, std::abs(metric.x / du - 1.0), std::abs(metric.y / dv - 1.0)});
            worst.cosine = std::max(worst.cosine, std::abs(metric.z - glm::dot(p.du, p.dv) / (du * dv)));
            worst.area = std::max(worst.area, std::abs(metric.w / glm::length(glm::cross(p.du, p.dv)) - 1.0));
        }
    }
    std::printf("  %d texels: position %.2f ulp, normal %.1e, step %.1e, cosine %.1e, area %.1e\n",
                worst.texels, worst.position_ulps, worst.normal, worst.step, worst.cosine, worst.area);
    return worst;
}

void expect_exact(const Worst& worst) {
    EXPECT_GT(worst.texels, 200);
    EXPECT_EQ(worst.missing, 0);
    EXPECT_EQ(worst.surplus, 0);
    // Vertices are rounded once in the world, weights once, and two products and two sums follow.
    EXPECT_LE(worst.position_ulps, 3.0);
    EXPECT_LE(worst.normal, 4e-7);
    // Texture coordinates are floats: their differences across a triangle of a few texels have 1e-5 of it.
    EXPECT_LE(worst.step, 3e-5);
    EXPECT_LE(worst.cosine, 3e-5);
    EXPECT_LE(worst.area, 3e-5);
}

MeshData bent_sheet() {
    return sheet(
        9, 7,
        [](double s, double t) {
            return glm::dvec3(80.0 * s - 40.0, 60.0 * t, 12.0 * std::sin(3.0 * s) * std::cos(2.0 * t));
        },
        [](double s, double t) {
            return glm::dvec2(0.12 + 0.7 * s + 0.06 * t * t, 0.1 + 0.75 * t + 0.05 * s * t);
        });
}

TEST(TissueBake, ABentSheetAgreesWithTheReference) {
    BakeStage stage;
    const MeshData mesh = bent_sheet();
    stage.use(mesh);
    expect_exact(against_reference(stage.bake(), surface_of(mesh)));
}

TEST(TissueBake, APlacedAndMirroredSheetAgreesWithTheReference) {
    BakeStage stage;
    MeshData mesh = bent_sheet();
    stage.use(mesh);
    const PlacementParams placement{
        .move_mm = {7.0, -3.0, 11.0}, .rotate_deg = {20.0, -35.0, 50.0}, .scale = {-1.5, 1.0, 0.7}};
    stage.parameters["mesh"]["placement"] = {
        {"move_mm", {7, -3, 11}}, {"rotate_deg", {20, -35, 50}}, {"scale", {-1.5, 1, 0.7}}};
    const Bounds box = mesh.bounds();
    const glm::dmat4 to_world =
        placement_matrix(placement, 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max)));
    reference::BakedSurface surface = surface_of(mesh);
    const glm::dmat3 turn = glm::transpose(glm::inverse(glm::dmat3(to_world)));
    for (std::size_t v = 0; v < surface.positions.size(); ++v) {
        surface.positions[v] = glm::dvec3(to_world * glm::dvec4(surface.positions[v], 1.0));
        surface.normals[v] = glm::normalize(turn * surface.normals[v]);
    }
    expect_exact(against_reference(stage.bake(), surface));
}

TEST(TissueBake, AnOrganOfAThousandthOrOfTenThousandIsTheSamePicture) {
    BakeStage stage;
    const MeshData mesh = bent_sheet();
    stage.use(mesh);
    const Baked one = stage.bake();
    for (const double size : {0x1.0p-16, 0x1.0p13}) {
        stage.parameters["mesh"]["mm_per_unit"] = size;
        const Baked other = stage.bake();
        int differ = 0;
        for (int y = 0; y < one.height; ++y) {
            for (int x = 0; x < one.width; ++x) {
                const glm::vec4 a = one.at(one.position, x, y);
                const glm::vec4 b = other.at(other.position, x, y);
                const glm::vec4 m = one.at(one.metric, x, y);
                const glm::vec4 n = other.at(other.metric, x, y);
                const auto f = static_cast<float>(size);
                // Lengths times a power of 2 keep every bit.
                const bool same = glm::vec3(b) == f * glm::vec3(a) && b.w == a.w && n.x == f * m.x &&
                                  n.y == f * m.y && n.z == m.z && n.w == f * f * m.w &&
                                  one.at(one.normal, x, y) == other.at(other.normal, x, y) &&
                                  one.at(one.seam, x, y) == other.at(other.seam, x, y);
                differ += same ? 0 : 1;
            }
        }
        EXPECT_EQ(differ, 0) << "at " << size;
    }
}

TEST(TissueBake, ACylinderUnrollsWithoutStretch) {
    // A strip once around, cut open: in the texture a rectangle, whose left and right borders are one line.
    constexpr int facets = 48;
    constexpr double radius = 20.0;
    constexpr double height = 70.0;
    const double facet = 2.0 * radius * std::sin(pi / facets);
    const glm::dvec2 corner(0.2, 0.15);
    const double width = 0.6;
    const double scale = width / (facets * facet);  // texture widths per mm
    const MeshData mesh = sheet(
        facets, 4,
        [&](double s, double t) {
            // The last column is the first one, to the bit.
            const double angle = 2.0 * pi * (s == 1.0 ? 0.0 : s);
            return glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), height * t);
        },
        [&](double s, double t) { return corner + glm::dvec2(width * s, scale * height * t); });
    BakeStage stage;
    stage.parameters["size"] = 96;
    stage.use(mesh);
    const Baked baked = stage.bake();
    const double texel = 1.0 / (96.0 * scale);
    int inside = 0;
    int beyond = 0;
    for (int y = 0; y < baked.height; ++y) {
        for (int x = 0; x < baked.width; ++x) {
            const glm::dvec2 uv = baked.uv(x, y);
            const glm::dvec2 from_corner = uv - corner;
            const bool in_height = from_corner.y > 1e-6 && from_corner.y < scale * height - 1e-6;
            if (baked.inside(x, y)) {
                ++inside;
                const glm::vec4 metric = baked.at(baked.metric, x, y);
                EXPECT_NEAR(metric.x, texel, 3e-5 * texel);
                EXPECT_NEAR(metric.y, texel, 3e-5 * texel);
                EXPECT_NEAR(metric.z, 0.0, 3e-5);
                EXPECT_NEAR(metric.w, texel * texel, 1e-4 * texel * texel);
                const glm::dvec3 p(baked.at(baked.position, x, y));
                EXPECT_NEAR(p.z, from_corner.y / scale, 2e-4);
                EXPECT_NEAR(glm::length(glm::dvec2(p)), radius,
                            radius * (1.0 - std::cos(pi / facets)) + 1e-4);
            } else if (baked.gutter(x, y) && in_height && (from_corner.x < 0.0 || from_corner.x > width)) {
                // Once around: the same height, a whole circumference away.
                ++beyond;
                const glm::vec4 seam = baked.at(baked.seam, x, y);
                const double around = from_corner.x < 0.0 ? width : -width;
                EXPECT_NEAR(seam.x, uv.x + around, 2e-5);
                EXPECT_NEAR(seam.y, uv.y, 2e-5);
            }
        }
    }
    EXPECT_GT(inside, 1800);
    EXPECT_GT(beyond, 300);
}

TEST(TissueBake, ASphereHasItsOwnMetric) {
    // Longitude and latitude, poles left out.
    constexpr double radius = 30.0;
    const double widest = 70.0 * pi / 180.0;
    const MeshData mesh = sheet(
        72, 56,
        [&](double s, double t) {
            const double longitude = 2.0 * pi * (s == 1.0 ? 0.0 : s);
            const double latitude = widest * (2.0 * t - 1.0);
            return radius * glm::dvec3(std::cos(latitude) * std::cos(longitude),
                                       std::cos(latitude) * std::sin(longitude), std::sin(latitude));
        },
        [](double s, double t) { return glm::dvec2(0.1 + 0.8 * s, 0.1 + 0.8 * t); });
    BakeStage stage;
    stage.use(mesh);
    const Baked baked = stage.bake();
    double worst_place = 0.0;
    double worst_u = 0.0;
    double worst_v = 0.0;
    for (int y = 0; y < baked.height; ++y) {
        for (int x = 0; x < baked.width; ++x) {
            if (!baked.inside(x, y)) {
                continue;
            }
            const glm::dvec2 st = (baked.uv(x, y) - 0.1) / 0.8;
            const double latitude = widest * (2.0 * st.y - 1.0);
            const double longitude = 2.0 * pi * st.x;
            const glm::dvec3 expected =
                radius * glm::dvec3(std::cos(latitude) * std::cos(longitude),
                                    std::cos(latitude) * std::sin(longitude), std::sin(latitude));
            const glm::vec4 metric = baked.at(baked.metric, x, y);
            const double du = 2.0 * pi * radius * std::cos(latitude) / 0.8 / 64.0;
            const double dv = 2.0 * widest * radius / 0.8 / 64.0;
            worst_place =
                std::max(worst_place, glm::distance(expected, glm::dvec3(baked.at(baked.position, x, y))));
            worst_u = std::max(worst_u, std::abs(metric.x / du - 1.0));
            worst_v = std::max(worst_v, std::abs(metric.y / dv - 1.0));
        }
    }
    std::printf("  place %.4f mm, du %.4f, dv %.4f\n", worst_place, worst_u, worst_v);
    // Facets of 5 degrees: r (1 - cos 2.5 degrees) below the sphere, up to twice that across a quad; a
    // facet's width is that of one of its edges, which differ by tan(70 degrees) * 2.5 degrees.
    EXPECT_LT(worst_place, 2.0 * radius * (1.0 - std::cos(2.5 * pi / 180.0)));
    EXPECT_LT(worst_u, 0.13);
    EXPECT_LT(worst_v, 0.01);
}

TEST(TissueBake, TheMetricIsWhatNeighbouringTexelsLieApart) {
    BakeStage stage;
    const MeshData mesh = bent_sheet();
    const reference::BakedSurface surface = surface_of(mesh);
    stage.use(mesh);
    const Baked baked = stage.bake();
    const glm::dvec2 texels(baked.width, baked.height);
    int compared = 0;
    for (int y = 0; y + 1 < baked.height; ++y) {
        for (int x = 0; x + 1 < baked.width; ++x) {
            const auto here = reference::baked_point(surface, baked.uv(x, y), texels);
            const auto right = reference::baked_point(surface, baked.uv(x + 1, y), texels);
            const auto up = reference::baked_point(surface, baked.uv(x, y + 1), texels);
            if (!here || !right || !up || here->triangle != right->triangle ||
                here->triangle != up->triangle) {
                continue;
            }
            ++compared;
            const glm::dvec3 p(baked.at(baked.position, x, y));
            const glm::dvec3 du = glm::dvec3(baked.at(baked.position, x + 1, y)) - p;
            const glm::dvec3 dv = glm::dvec3(baked.at(baked.position, x, y + 1)) - p;
            const glm::vec4 metric = baked.at(baked.metric, x, y);
            EXPECT_NEAR(metric.x, glm::length(du), 2e-5);
            EXPECT_NEAR(metric.y, glm::length(dv), 2e-5);
            EXPECT_NEAR(metric.w, glm::length(glm::cross(du, dv)), 5e-5);
        }
    }
    EXPECT_GT(compared, 500);
}

TEST(TissueBake, GltfCountsVFromTheTop) {
    BakeStage stage;
    stage.parameters["mesh"] = {{"file", std::string(VISCERA_SOURCE_DIR) + "/assets/meshes/abdomen.glb"}};
    const Baked baked = stage.bake();
    // The wall rises to the front, which is up in its texture: y falls as v grows.
    EXPECT_GT(baked.position.at(32, 8, 1), baked.position.at(32, 56, 1));
    EXPECT_LT(baked.position.at(8, 32, 0), baked.position.at(56, 32, 0));
}

}  // namespace
}  // namespace viscera::test

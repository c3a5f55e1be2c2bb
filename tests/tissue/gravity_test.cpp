#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// Which way is down, against closed forms, and where there is none.
namespace viscera::test {
namespace {

using std::numbers::pi;
using Texel = reference::TissueSurface::Texel;

/// What a texel of the gravity map says, as a way in the world per mm.
struct Downhill {
    glm::dvec2 direction{0.0};
    double factor = 0.0;
    double uv_per_mm = 0.0;
};

Downhill at(const Image& map, int x, int y) {
    return {{map.at(x, y, 0), map.at(x, y, 1)}, map.at(x, y, 2), map.at(x, y, 3)};
}

TEST(GravityMap, IsExactOnAPlane) {
    BloodStage stage(128);
    // The texture lies askew on the plane, and is stretched.
    const SurfaceChart& chart = askew_chart;
    const glm::dvec3 a = glm::normalize(glm::dvec3(1.0, 0.2, -0.4));
    const glm::dvec3 b = glm::normalize(glm::cross(glm::dvec3(0.3, 1.0, 0.5), a));
    stage.surface(std::span(&chart, 1), [&](glm::dvec2 p) { return p.x * a + p.y * b; });
    stage.gravity = {{"gravity_m_s2", {1.0, -7.0, 3.0}}};
    stage.load();
    stage.frame(0.0);
    const Image map = stage.read("tissue.gravity");
    expect_finite(map);
    const glm::dvec3 down = glm::normalize(glm::dvec3(1.0, -7.0, 3.0));
    const glm::dvec2 along(glm::dot(down, a), glm::dot(down, b));  // mm of a and b per mm of fall
    const glm::dvec2 uv = (along.x * chart.a_px + along.y * chart.b_px) / 128.0;
    double worst = 0.0;
    const Image position = stage.read("tissue.position");
    int cells = 0;
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) {
            if (position.at(x, y, 3) != 1.0F) {
                continue;
            }
            ++cells;
            const Downhill found = at(map, x, y);
            worst = std::max({worst, glm::length(found.direction - glm::normalize(uv)),
                              std::abs(found.factor - glm::length(along)),
                              std::abs(found.uv_per_mm / (glm::length(uv) / glm::length(along)) - 1.0)});
        }
    }
    std::printf("  %d texels, off by %.1e at most\n", cells, worst);
    EXPECT_GT(cells, 4000);
    EXPECT_LT(worst, 1e-4);
}

TEST(GravityMap, FollowsMeridiansOfASphere) {
    BloodStage stage(128);
    const SurfaceChart chart{.low = {0.0, 10.0},
                             .high = {60.0, 170.0},
                             .origin_px = {14.0, 6.0},
                             .a_px = {1.5, 0.0},
                             .b_px = {0.0, 0.65},
                             .cells = {60, 160}};
    constexpr double radius = 50.0;
    stage.surface(std::span(&chart, 1), [](glm::dvec2 p) {
        const double theta = p.y * pi / 180.0;
        const double phi = p.x * pi / 180.0;
        return radius *
               glm::dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
    });
    stage.gravity = {{"gravity_m_s2", {0, 0, -9.8}}};
    stage.load();
    stage.frame(0.0);
    const Image map = stage.read("tissue.gravity");
    const auto surface = stage.baked();
    double worst_way = 0.0;
    double worst_factor = 0.0;
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 128; ++x) {
            const std::size_t i = surface.index(x, y);
            if (surface.kind[i] == Texel::cell) {
                const glm::dvec3 p = surface.position[i];
                const Downhill found = at(map, x, y);
                worst_way =
                    std::max(worst_way, std::abs(std::atan2(found.direction.x * surface.metric[i].x,
                                                            found.direction.y * surface.metric[i].y)));
                worst_factor =
                    std::max(worst_factor, std::abs(found.factor - std::hypot(p.x, p.y) / glm::length(p)));
            }
        }
    }
    std::printf("  way off by %.1e, share of gravity by %.1e\n", worst_way, worst_factor);
    // The mesh has facets of a degree, and at borders, where differences are one-sided, half a texel is
    // 0.013.
    EXPECT_LT(worst_way, 0.01);
    EXPECT_LT(worst_factor, 0.017);
}

TEST(GravityMap, IsZeroWhereNothingIsDownhill) {
    const SurfaceChart chart{.high = {40.0, 40.0}, .origin_px = {10.0, 10.0}};
    // Level; without gravity; on triangles without area, in the world or in the texture.
    for (int which = 0; which < 4; ++which) {
        BloodStage stage(64);
        SurfaceChart drawn = chart;
        if (which == 3) {
            drawn.b_px = {1.0, 0.0};
        }
        stage.surface(std::span(&drawn, 1), [&](glm::dvec2 p) {
            return which == 2 ? glm::dvec3(p.x, 0.0, p.x) : glm::dvec3(p, 0.0);
        });
        stage.gravity = {{"gravity_m_s2", {0.0, 0.0, which == 1 ? 0.0 : -9.8}}};
        stage.load();
        stage.frame(0.0);
        const Image map = stage.read("tissue.gravity");
        for (const float value : to_floats(map)) {
            ASSERT_EQ(value, 0.0F) << which;
        }
    }
}

TEST(GravityMap, IsMadeAgainOnlyWhenGravityTurns) {
    BloodStage stage(96);
    const SurfaceChart chart{.high = {40.0, 40.0}, .origin_px = {10.0, 10.0}};
    stage.surface(std::span(&chart, 1), [](glm::dvec2 p) { return glm::dvec3(p, 0.0); });
    stage.load();
    const auto status = [&](double time, const HostValues* values) {
        return to_string(pass_of(stage.frame(time, values), "gravity").status);
    };
    HostValues values;
    EXPECT_EQ(status(0.0, &values), "run");
    EXPECT_EQ(status(0.1, &values), "cached");
    values.set("tissue.gravity", std::array{9.8F, 0.0F, 0.0F});
    EXPECT_EQ(status(0.2, &values), "run");
    EXPECT_NEAR(stage.read("tissue.gravity").at(30, 30, 0), 1.0F, 1e-6F);
    EXPECT_EQ(status(0.3, &values), "cached");
    // Nonsense is a fault, and the scene's gravity counts.
    values.set("tissue.gravity", std::array{9.8F, std::nanf(""), 0.0F});
    EXPECT_EQ(status(0.4, &values), "run");
    EXPECT_NEAR(stage.read("tissue.gravity").at(30, 30, 1), 1.0F, 1e-6F);
    const auto faults = [&] { return stage.stage().renderer().log().faults(); };
    EXPECT_EQ(faults().count("tissue.gravity"), 1U);
    // So is more than a scene may have, and none at all is said.
    const std::uint64_t before = faults().at("tissue.gravity");
    values.set("tissue.gravity", std::array{0.0F, 1000.0F, 0.0F});
    EXPECT_EQ(status(0.5, &values), "run");
    EXPECT_EQ(faults().at("tissue.gravity"), before);
    values.set("tissue.gravity", std::array{1e30F, 0.0F, 0.0F});
    EXPECT_EQ(status(0.6, &values), "run");
    EXPECT_EQ(faults().at("tissue.gravity"), before + 1);
    EXPECT_NEAR(stage.read("tissue.gravity").at(30, 30, 1), 1.0F, 1e-6F);
    EXPECT_FALSE(faults().contains("tissue.no_gravity"));
    values.set("tissue.gravity", std::array{0.0F, 0.0F, 0.0F});
    status(0.7, &values);
    EXPECT_TRUE(faults().contains("tissue.no_gravity"));
}

}  // namespace
}  // namespace viscera::test

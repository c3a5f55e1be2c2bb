#include <cmath>

#include <gtest/gtest.h>

#include "tests/tissue/blood_stage.h"

// The film on the GPU against the same scheme in double precision, on a bent surface of two charts.
namespace viscera::test {
namespace {

/// Steps a film on a bent surface of two charts, in a relief or without one, its edge pinned or not.
void compare(bool relief, double pinning_mm, std::initializer_list<int> steps_until) {
    BloodStage stage(96);
    const std::array<SurfaceChart, 2> charts{SurfaceChart{.high = {30.0, 40.0},
                                                          .origin_px = {8.0, 8.0},
                                                          .a_px = {1.0, 0.15},
                                                          .b_px = {0.0, 1.1},
                                                          .cells = {15, 20}},
                                             SurfaceChart{.low = {30.0, 0.0},
                                                          .high = {60.0, 40.0},
                                                          .origin_px = {47.4, -23.0},
                                                          .a_px = {0.0, 1.0},
                                                          .b_px = {1.0, 0.0},
                                                          .cells = {15, 20}}};
    stage.surface(charts, [](glm::dvec2 p) {
        return glm::dvec3(p, 0.01 * (p.x - 35.0) * (p.x - 35.0) + 0.02 * (p.y - 15.0) * (p.y - 15.0));
    });
    stage.gravity = {{"gravity_m_s2", {0.0, 2.0, -9.0}}, {"spreading", 0.1}};
    constexpr double pull = 6.0;
    stage.gravity["relief_pull"] = pull;
    stage.blood = {
        {"liquid",
         {{"residual_mm", 0.02}, {"pinning_mm", pinning_mm}, {"drying_mm_s", 0.01}, {"steps_per_s", 120.0}}}};
    if (relief) {
        // Here and there steeper than what counts.
        stage.relief([](const glm::dvec3& p) { return 0.15 * std::sin(1.1 * p.x) * std::cos(0.9 * p.y); });
    }
    // An edge that may be pinned lies along the seam.
    const auto spilt = [&](const glm::dvec3& p) {
        return pinning_mm > 0.0 && p.x > 30.0 ? 0.0 : 0.3 + 0.2 * std::sin(0.5 * p.x) * std::cos(0.6 * p.y);
    };
    stage.spill(spilt);
    stage.frame(0.0);
    reference::TissueSurface surface = stage.baked();
    if (relief) {
        for (const float height : to_floats(stage.read("tissue.relief"))) {
            surface.lift.push_back(pull * static_cast<double>(height));
        }
    }
    const Image start = stage.read("tissue.blood_height");
    const double strength = std::hypot(2.0, 9.0) / 9.80665;
    const reference::Flow flow =
        reference::flow_of(surface, strength * glm::normalize(glm::dvec3(0.0, 2.0, -9.0)), 0.1, true);
    EXPECT_GT(flow.links.size(), 60U);
    reference::Film film(surface.kind.size());
    for (std::size_t i = 0; i < film.height_mm.size(); ++i) {
        film.height_mm[i] =
            flow.area_mm2[i] > 0.0 ? start.at(static_cast<int>(i % 96), static_cast<int>(i / 96), 0) : 0.0;
    }
    const reference::FilmParams params{.mobility_per_mm_s = 1060.0 * 9.80665 / 4.0,
                                       .residual_mm = 0.02,
                                       .pinning_mm = pinning_mm,
                                       .drying_mm_s = 0.01};
    int steps = 0;
    for (const int until : steps_until) {
        for (; steps < until; ++steps) {
            film.step(surface, flow, params, 1.0 / 120.0);
        }
        stage.run(stage.time_s(), until / 120.0, until < 4 ? 1.0 / 120.0 : 0.05);
        const Image height = stage.read("tissue.blood_height");
        double worst = 0.0;
        double difference = 0.0;
        double sum = 0.0;
        for (std::size_t i = 0; i < film.height_mm.size(); ++i) {
            if (flow.area_mm2[i] > 0.0) {
                const double found = height.at(static_cast<int>(i % 96), static_cast<int>(i / 96), 0);
                const double expected = film.height_mm[i] + film.owed_mm[i];
                worst = std::max(worst, std::abs(found - expected));
                difference += std::abs(found - expected) * flow.area_mm2[i];
                sum += expected * flow.area_mm2[i];
            }
        }
        const BloodAccount account = stage.account();
        std::printf(
            "  %3d steps: heights differ by %.1e mm at most, %.1e of the volume; gone %.4f, reference %.4f "
            "mm^3\n",
            until, worst, difference / sum, account.gone, film.gone_mm3(flow));
        EXPECT_LT(worst, until == 1 ? 1e-6 : 2e-5);
        EXPECT_LT(difference / sum, 1e-6);
        EXPECT_NEAR(account.gone / film.gone_mm3(flow), 1.0, 1e-4);
        EXPECT_NEAR(account.film / film.volume_mm3(flow), 1.0, 1e-5);
    }
}

TEST(BloodReference, TheFilmIsTheReferencesStepByStep) {
    compare(false, 0.0, {1, 24, 240});
}

TEST(BloodReference, SoItIsInARelief) {
    compare(true, 0.0, {1, 24, 240});
}

TEST(BloodReference, SoItIsWhereItsEdgeIsPinned) {
    // A pinned edge gives way all at once, where it is highest: no rounding stays small for long.
    compare(true, 0.25, {1, 24});
}

}  // namespace
}  // namespace viscera::test

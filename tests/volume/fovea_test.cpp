#include <gtest/gtest.h>

#include <limits>

#include "tests/volume/mixed_scene.h"

// Longer steps away from where one looks: each region is the picture with that region's step.

namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int fovea_side = 96;

class Fovea : public testing::TestWithParam<ComputeUse> {
  protected:
    static json scene_with(const json& sampling) {
        json parameters{{"transfer_function", shell_function()}, {"sampling", sampling}};
        return mixed_scene(json::array(), parameters, camera_at({60, -420, 90}), fovea_side, fovea_side);
    }
    Image shot(const json& sampling) { return mixed_shot(stage_, scene_with(sampling), volume_); }
    /// Radius of a pixel about a centre in UV, in heights of the picture.
    static double away(int x, int y, const glm::dvec2& centre) {
        return glm::distance((glm::dvec2(x, y) + 0.5) / static_cast<double>(fovea_side), centre);
    }

    LiveVolume volume_{shell_volume()};
    Stage stage_{Backend::osmesa, {}, GetParam()};
};

TEST_P(Fovea, EachRegionHasItsStepsPicture) {
    const glm::dvec2 centre(0.4, 0.55);
    const json fovea{
        {"centre", {centre.x, centre.y}}, {"radius", 0.12}, {"outer_radius", 0.3}, {"step_factor", 4}};
    const Image got = shot({{"step", 0.5}, {"fovea", fovea}});
    const Image fine = shot({{"step", 0.5}});
    const Image coarse = shot({{"step", 2.0}});
    std::size_t within = 0;
    std::size_t beyond = 0;
    for (int y = 0; y < fovea_side; ++y) {
        for (int x = 0; x < fovea_side; ++x) {
            const double r = away(x, y, centre);
            for (int c = 0; c < 4; ++c) {
                if (r < 0.119) {
                    ASSERT_EQ(got.at(x, y, c), fine.at(x, y, c)) << x << "," << y;
                    within += fine.at(x, y, c) != coarse.at(x, y, c) ? 1U : 0U;
                } else if (r > 0.301) {
                    ASSERT_EQ(got.at(x, y, c), coarse.at(x, y, c)) << x << "," << y;
                    beyond += fine.at(x, y, c) != coarse.at(x, y, c) ? 1U : 0U;
                }
            }
        }
    }
    EXPECT_GT(within, 300U);
    EXPECT_GT(beyond, 300U);
}

TEST_P(Fovea, EachRayHasTheStepOfItsPlace) {
    // Looked up without jumps, so that a step that is rounded otherwise moves samples and nothing else.
    const auto shown = [&](const json& sampling) {
        json scene = scene_with(sampling);
        scene["passes"].back()["parameters"]["transfer_function"]["interpolate"] = true;
        return mixed_shot(stage_, scene, volume_);
    };
    const Image got =
        shown({{"step", 0.5}, {"fovea", {{"radius", 0.1}, {"outer_radius", 0.45}, {"step_factor", 4}}}});
    std::size_t compared = 0;
    for (const int x : {60, 64, 68, 71, 74}) {
        const int y = 52;
        const double t = std::clamp((away(x, y, {0.5, 0.5}) - 0.1) / 0.35, 0.0, 1.0);
        const double factor = 1.0 + 3.0 * t * t * (3.0 - 2.0 * t);
        const Image everywhere = shown({{"step", 0.5 * factor}});
        for (int c = 0; c < 4; ++c) {
            // Steps differ by 2^-22, so that samples move by 2^-22 of 250 mm at most. No colour or opacity of
            // the shells changes by more than 0.15 per mm.
            EXPECT_NEAR(got.at(x, y, c), everywhere.at(x, y, c), 0.15 * 250.0 / 4194304.0)
                << x << ", " << factor;
        }
        compared += got.at(x, y, 3) > 0.1F ? 1 : 0;
    }
    EXPECT_GE(compared, 3U);
}

TEST_P(Fovea, NoRingIsSeen) {
    // Longer steps err by this or that from pixel to pixel, as they do everywhere. A ring is what all pixels
    // of a circle have in common: that they err otherwise than they would with the step of the next circle.
    const auto worst_ring = [&](double radius, double outer_radius, double factor) {
        const double pixel = 1.0 / fovea_side;
        const auto with = [&](double by) {
            return shot(
                {{"step", 0.25},
                 {"fovea",
                  {{"radius", radius + by}, {"outer_radius", outer_radius + by}, {"step_factor", factor}}}});
        };
        const Image here = with(0.0);
        const Image next = with(pixel);
        std::array<std::array<double, 4>, fovea_side> sums{};
        std::array<int, fovea_side> counts{};
        for (int y = 0; y < fovea_side; ++y) {
            for (int x = 0; x < fovea_side; ++x) {
                const auto circle = static_cast<std::size_t>(away(x, y, {0.5, 0.5}) * fovea_side);
                ++counts.at(circle);
                for (int c = 0; c < 4; ++c) {
                    sums.at(circle).at(static_cast<std::size_t>(c)) +=
                        static_cast<double>(here.at(x, y, c)) - static_cast<double>(next.at(x, y, c));
                }
            }
        }
        double worst = 0.0;
        for (std::size_t circle = 5; circle < fovea_side / 2; ++circle) {
            for (const double sum : sums.at(circle)) {
                worst = std::max(worst, std::abs(sum) / counts.at(circle));
            }
        }
        return worst;
    };
    const double step_of_a_screen = 1.0 / 255.0;
    EXPECT_LT(worst_ring(0.12, 0.3, 4), step_of_a_screen);
    EXPECT_LT(worst_ring(0.1, 0.4, 16), step_of_a_screen);
    EXPECT_GT(worst_ring(0.1, 0.1 + 1e-6, 16), step_of_a_screen) << "without a transition a ring is seen";
    EXPECT_GT(worst_ring(0.2, 0.2 + 1e-6, 16), step_of_a_screen);
}

TEST_P(Fovea, SkippingChangesNothing) {
    for (const char* scheme : {"midpoint", "gauss", "preintegrated"}) {
        json sampling{{"scheme", scheme},
                      {"fovea", {{"radius", 0.05}, {"outer_radius", 0.4}, {"step_factor", 6}}}};
        const Image skipped = shot(sampling);
        sampling["skip"] = false;
        const Difference d = difference(shot(sampling), skipped);
        EXPECT_EQ(d.max, 0.0) << scheme;
        EXPECT_GT(d.seen, 1000U);
    }
}

TEST_P(Fovea, AFactorOfOneChangesNothing) {
    EXPECT_EQ(difference(shot({{"fovea", {{"step_factor", 1}}}}), shot(json::object())).max, 0.0);
}

TEST_P(Fovea, TheHostSaysWhereEachEyeLooks) {
    const auto look_at = [&](std::vector<float> gaze, int eye_count) {
        json scene = scene_with({{"fovea", {{"host", "gaze"}, {"radius", 0.1}, {"outer_radius", 0.2}}}});
        stage_.load(scene);
        HostValues values;
        values.set("gaze", gaze);
        const HostVolume given{"host", &volume_};
        Frame frame = stage_.renderer().still(0.0);
        frame.eyes[1] = frame.eyes[0];
        frame.eye_count = eye_count;
        frame.values = &values;
        frame.volumes = std::span(&given, 1);
        stage_.renderer().render(frame);
        std::vector<Image> pictures;
        for (const std::string& name : stage_.renderer().names_of("volume.colour")) {
            pictures.push_back(stage_.renderer().read(name));
        }
        return pictures;
    };
    const auto from_scene = [&](double u, double v) {
        return shot({{"fovea", {{"centre", {u, v}}, {"radius", 0.1}, {"outer_radius", 0.2}}}});
    };
    stage_.make_current();
    EXPECT_EQ(difference(look_at({0.25F, 0.75F}, 1)[0], from_scene(0.25, 0.75)).max, 0.0);
    const std::vector<Image> both = look_at({0.25F, 0.75F, 0.5F, 0.375F}, 2);
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(difference(both[0], from_scene(0.25, 0.75)).max, 0.0);
    EXPECT_EQ(difference(both[1], from_scene(0.5, 0.375)).max, 0.0);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(difference(look_at({nan, 0.5F}, 1)[0], from_scene(0.5, 0.5)).max, 0.0) << "the eye is lost";
    EXPECT_EQ(difference(look_at({0.1F}, 1)[0], from_scene(0.5, 0.5)).max, 0.0) << "too few numbers";
}

TEST_P(Fovea, ALookElsewhereIsDrawnAndTheSameIsNot) {
    stage_.make_current();
    stage_.load(scene_with({{"fovea", {{"host", "gaze"}}}}));
    HostValues values;
    const HostVolume given{"host", &volume_};
    const auto status = [&](float u) {
        values.set("gaze", std::vector<float>{u, 0.5F});
        Frame frame = stage_.renderer().still(0.0);
        frame.values = &values;
        frame.volumes = std::span(&given, 1);
        return pass_of(stage_.renderer().render(frame), "cast").status;
    };
    EXPECT_EQ(status(0.5F), PassStatus::reduced);
    EXPECT_EQ(status(0.5F), PassStatus::cached);
    EXPECT_EQ(status(0.6F), PassStatus::reduced);
}

TEST_P(Fovea, RadiiInTheWrongOrderAreRefused) {
    stage_.make_current();
    try {
        stage_.load(scene_with({{"fovea", {{"radius", 0.5}, {"outer_radius", 0.5}}}}));
        ADD_FAILURE() << "not refused";
    } catch (const Error& error) {
        EXPECT_NE(std::string_view(error.what()).find("/sampling/fovea/outer_radius"), std::string_view::npos)
            << error.what();
    }
}

INSTANTIATE_TEST_SUITE_P(By, Fovea, testing::Values(ComputeUse::off, ComputeUse::on), [](const auto& info) {
    return info.param == ComputeUse::on ? "ComputeShader" : "FragmentShader";
});

}  // namespace
}  // namespace viscera::test

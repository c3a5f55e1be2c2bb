#include <gtest/gtest.h>

#include <limits>

#include "tests/volume/mixed_scene.h"

// Longer steps away from where one looks: each region is the picture with that region's step.

namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int side = 96;

class Fovea : public testing::TestWithParam<ComputeUse> {
  protected:
    static json scene_with(const json& sampling) {
        json parameters{{"transfer_function", shell_function()}, {"sampling", sampling}};
        return mixed_scene(json::array(), parameters, camera_at({60, -420, 90}), side, side);
    }
    Image shot(const json& sampling) { return mixed_shot(stage_, scene_with(sampling), volume_); }
    /// Radius of a pixel about a centre in UV, in heights of the picture.
    static double away(int x, int y, const glm::dvec2& centre) {
        return glm::distance((glm::dvec2(x, y) + 0.5) / static_cast<double>(side), centre);
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
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
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

TEST_P(Fovea, NoRingIsSeen) {
    const json fovea{{"radius", 0.12}, {"outer_radius", 0.3}, {"step_factor", 4}};
    const Image fine = shot({{"step", 0.25}});
    // How much the error of a picture changes from a pixel to the next, at most.
    const auto worst_step = [&](const Image& got) {
        double worst = 0.0;
        const auto error = [&](int x, int y, int c) {
            return static_cast<double>(got.at(x, y, c)) - static_cast<double>(fine.at(x, y, c));
        };
        for (int y = 0; y + 1 < side; ++y) {
            for (int x = 0; x + 1 < side; ++x) {
                for (int c = 0; c < 4; ++c) {
                    worst = std::max({worst, std::abs(error(x + 1, y, c) - error(x, y, c)),
                                      std::abs(error(x, y + 1, c) - error(x, y, c))});
                }
            }
        }
        return worst;
    };
    // That steps change adds nothing to what the longer step errs by everywhere.
    const double coarse = worst_step(shot({{"step", 1.0}}));
    const double foveated = worst_step(shot({{"step", 0.25}, {"fovea", fovea}}));
    EXPECT_LT(foveated, 1.2 * coarse);
    EXPECT_LT(foveated, 0.02);
    EXPECT_GT(foveated, 0.0) << "steps were to be longer somewhere";
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

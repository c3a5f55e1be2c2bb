#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include <gtest/gtest.h>

#include "effects/organ/depth_of_field_effect.h"
#include "engine/io/exr.h"
#include "tests/effects/deviation.h"
#include "tests/effects/scenes.h"
#include "tests/effects/stage.h"
#include "tests/io/temp_folder.h"
#include "tests/reference/organ.h"

namespace viscera::test {
namespace {

using nlohmann::json;

constexpr int width = 96;
constexpr int height = 64;
constexpr double radius = 0.125;  // 8 pixels: times a half it is exact, so both find the same texels

class DepthOfField : public testing::Test {
  protected:
    json scene(const std::function<float(int x, int y, int c)>& f, json parameters = json::object()) {
        Image image = make_image(width, height, PixelFormat::rgba16f);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                for (int c = 0; c < 4; ++c) {
                    image.set(x, y, c, f(x, y, c));
                }
            }
        }
        const std::array<io::ExrPart, 1> parts{io::ExrPart{.name = "picture", .image = image}};
        const auto file = folder_ / ("picture" + std::to_string(++files_) + ".exr");
        io::write_exr(file, parts, io::ExrCompression::none);
        parameters["radius"] = parameters.value("radius", radius);
        json made = scene_of(tube_camera(),
                             {pass("fill", "picture.image",
                                   {{"file", file.string()}, {"fit", "stretch"}, {"monochrome", false}},
                                   {{"image", "organ.color"}}),
                              pass("depth_of_field", "organ.depth_of_field", parameters)},
                             {"final", "organ.color"}, width, height);
        return made;
    }
    Image picture() { return stage_.renderer().read("final"); }
    Image source() { return stage_.renderer().read("organ.color"); }

    TempFolder folder_;
    int files_ = 0;
    Stage stage_;
};

float noise(int x, int y, int c) {
    // Unsigned throughout: their overflow is defined.
    const unsigned h = (static_cast<unsigned>(x) * 73856093U) ^ (static_cast<unsigned>(y) * 19349663U) ^
                       (static_cast<unsigned>(c + 1) * 83492791U);
    return static_cast<float>((h * 2654435761U) >> 16) / 65535.0F;
}

/// Colours of noise; blurriness in waves or as noise.
float noisy(bool smooth, int x, int y, int c) {
    if (c < 3 || !smooth) {
        return noise(x, y, c);
    }
    return 0.5F + 0.5F * std::sin(0.08F * static_cast<float>(x)) * std::cos(0.05F * static_cast<float>(y));
}

TEST_F(DepthOfField, IsItsReference) {
    for (const bool smooth : {true, false}) {
        stage_.load(scene([&](int x, int y, int c) { return noisy(smooth, x, y, c); }, {{"taps", 32}}));
        stage_.render(0.0);
        std::vector<char> undecided;
        const reference::Buffer wanted = reference::depth_of_field(to_buffer(source()), radius * height,
                                                                   organ::disc_spiral(32), undecided);
        const auto decided = [&](int x, int y) {
            return undecided[static_cast<std::size_t>(y * width + x)] == 0;
        };
        for (int c = 0; c < 4; ++c) {
            const Deviation found = deviation(picture(), wanted, c, c, decided);
            EXPECT_LE(found.half_units, half_bound)
                << "channel " << c << " at " << found.x << ", " << found.y;
            EXPECT_GT(found.content, 5000U);
        }
        EXPECT_TRUE(stage_.complaints().empty());
        EXPECT_NE(picture().data, source().data);
    }
}

TEST_F(DepthOfField, AComputeShaderGivesTheSamePicture) {
    Stage compute(Backend::osmesa, {}, ComputeUse::on);
    for (const bool smooth : {true, false}) {
        const json s = scene([&](int x, int y, int c) { return noisy(smooth, x, y, c); });
        stage_.load(s);
        compute.load(s);
        EXPECT_EQ(pass_of(stage_.render(0.0), "depth_of_field").path, DrawPath::fragment);
        EXPECT_EQ(pass_of(compute.render(0.0), "depth_of_field").path, DrawPath::compute);
        // Fragments are stored by cutting half floats off, image stores round them.
        const Image stored = compute.renderer().read("final");
        const Deviation found = deviation(picture(), to_buffer(stored));
        EXPECT_LE(found.half_units, half_bound) << "at " << found.x << ", " << found.y;
        EXPECT_TRUE(compute.complaints().empty());
    }
}

/// What a gather of n places makes of one bright pixel, against a disc that is filled evenly: the root of the
/// sum of the squared differences is how far the mean of white noise of deviation 1 is off.
double noise_left(double disc, int count, const std::vector<glm::dvec2>& spiral) {
    constexpr int half = 14;
    constexpr int side = 2 * half + 1;
    std::vector<double> kernel(std::size_t{side} * side, 0.0);
    const auto at = [&](double x, double y) -> double& {
        return kernel[static_cast<std::size_t>(std::floor(y)) * side +
                      static_cast<std::size_t>(std::floor(x))];
    };
    constexpr double middle = half + 0.5;
    at(middle, middle) += 1.0 / (count + 1);
    for (int i = 0; i < count; ++i) {
        const glm::dvec2 way = disc / std::sqrt(count) * spiral[static_cast<std::size_t>(i)];
        at(middle + way.x, middle + way.y) += 1.0 / (count + 1);
    }
    std::vector<glm::dvec2> inside;
    constexpr int across = 128;  // samples of the disc's diameter
    for (int i = 0; i < across * across; ++i) {
        const glm::dvec2 p = (glm::dvec2(i % across, i / across) + 0.5) * (2.0 / across) - 1.0;
        if (glm::length(p) <= 1.0) {
            inside.push_back(disc * p + middle);
        }
    }
    for (const glm::dvec2& p : inside) {
        at(p.x, p.y) -= 1.0 / static_cast<double>(inside.size());
    }
    double sum = 0.0;
    for (const double value : kernel) {
        sum += value * value;
    }
    return std::sqrt(sum);
}

TEST(DiscTaps, FewerInSmallDiscsLeaveNoMoreNoiseThanAllInWideOnes) {
    for (const int taps : {4, 8, 12, 16, 24, 32, 40, 48, 56, 64, 80, 96, 128, 192, 256}) {
        const std::vector<glm::dvec2> spiral = organ::disc_spiral(taps);
        double worst = 0.0;
        for (double disc = 0.5; disc < 12.0; disc *= 1.013) {
            const int count = reference::taps_within(disc, taps);
            ASSERT_LE(count, taps);
            worst = std::max(worst, noise_left(disc, count, spiral) * std::sqrt(taps));
        }
        std::printf("  %3d taps: noise left times their root at most %.3f\n", taps, worst);
        EXPECT_LE(worst, taps <= 48 ? 1.0 : 1.15) << taps;
    }
    EXPECT_LE(reference::taps_within(1.0, 48), 17);
    EXPECT_LE(reference::taps_within(3.0, 48), 29);
    EXPECT_EQ(reference::taps_within(0.49, 48), 0);
}

TEST_F(DepthOfField, WhatIsSharpStaysAsItIs) {
    stage_.load(
        scene([](int x, int y, int c) { return c < 3 ? noise(x, y, c) : 0.5F + 0.01F * noise(x, y, 3); }));
    stage_.render(0.0);
    EXPECT_EQ(pass_of(stage_.render(0.0), "depth_of_field").status, PassStatus::cached);
    EXPECT_EQ(picture().data, source().data);
}

TEST_F(DepthOfField, ASharpForegroundDoesNotBleedIntoABlurredBackground) {
    // Bright and in focus on the left, dark and far out of focus on the right.
    const auto f = [](int x, int, int c) {
        const bool front = x < width / 2;
        return c < 3 ? (front ? 1.0F : 0.25F) : (front ? 0.5F : 1.0F);
    };
    stage_.load(scene(f));
    stage_.render(0.0);
    const Image image = picture();
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            // Beside the edge a front pixel's own disc, of a pixel's size, reaches half way across.
            const bool edge = x == width / 2;
            ASSERT_NEAR(image.at(x, y, 0), x < width / 2 ? 1.0F : 0.25F, edge ? 0.08F : 0.0F)
                << x << ", " << y;
        }
    }
    // The other way round: what is blurred in front lets the sharp background through at its edge.
    const auto g = [](int x, int, int c) {
        const bool front = x < width / 2;
        return c < 3 ? (front ? 1.0F : 0.25F) : (front ? 0.0F : 0.5F);
    };
    stage_.load(scene(g));
    stage_.render(0.0);
    const Image soft = picture();
    EXPECT_LT(soft.at(width / 2 - 1, 20, 0), 0.8F);
    EXPECT_GT(soft.at(width / 2 - 1, 20, 0), 0.4F);
    EXPECT_EQ(soft.at(width / 2 - 9, 20, 0), 1.0F);
    EXPECT_EQ(soft.at(width / 2, 20, 0), 0.25F);
}

TEST_F(DepthOfField, APlainPictureStaysPlain) {
    stage_.load(scene([](int x, int y, int c) { return c < 3 ? 0.625F : noise(x, y, c); }));
    stage_.render(0.0);
    const Image image = picture();
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            ASSERT_NEAR(image.at(x, y, 1), 0.625F, 5e-4F);
        }
    }
}

TEST_F(DepthOfField, RestsWhereNothingIsBlurredByHalfAPixel) {
    const auto f = [](int x, int y, int c) { return noise(x, y, c); };
    for (const json& parameters : {json{{"radius", 0.007}}, json{{"largest_blurriness", 0.06}}}) {
        stage_.load(scene(f, parameters));
        const PassReport report = pass_of(stage_.render(0.0), "depth_of_field");
        EXPECT_EQ(report.status, PassStatus::idle);
        EXPECT_EQ(report.reason, "nothing is blurred by half a pixel: the picture is its input");
        EXPECT_EQ(stage_.renderer().texture("final"), stage_.renderer().texture("organ.color"));
        EXPECT_EQ(picture().data, source().data);
    }
    // Just above it draws, and where the picture keeps its word that is the same picture.
    json s = scene([](int x, int y, int c) { return c < 3 ? noise(x, y, c) : 0.5F + 0.03F * noise(x, y, c); },
                   {{"largest_blurriness", 0.07}});
    stage_.load(s);
    EXPECT_EQ(pass_of(stage_.render(0.0), "depth_of_field").status, PassStatus::run);
    EXPECT_EQ(picture().data, source().data);
}

TEST(DiscTaps, AnyFirstOfThemAreSpreadEvenly) {
    const std::vector<glm::dvec2> spiral = organ::disc_spiral(256);
    for (const int count : {4, 11, 48, 256}) {
        glm::dvec2 mean(0.0);
        double second = 0.0;
        for (int i = 0; i < count; ++i) {
            const glm::dvec2 tap = spiral[static_cast<std::size_t>(i)] / std::sqrt(count);
            EXPECT_LE(glm::length(tap), 1.0);
            mean += tap / static_cast<double>(count);
            second += glm::dot(tap, tap) / count;
        }
        EXPECT_LE(glm::length(mean), 0.5 / std::sqrt(count));
        EXPECT_NEAR(second, 0.5, 1e-9);  // of a disc that is filled evenly
    }
}

}  // namespace
}  // namespace viscera::test

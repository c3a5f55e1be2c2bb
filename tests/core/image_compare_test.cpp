#include "engine/core/image_compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "engine/core/error.h"
#include "tests/core/not_finite.h"

namespace viscera {
namespace {

using testing::HasSubstr;

constexpr CompareLimits generous{1e30, 1e30, 1.0};

Image filled(int width, int height, PixelFormat format, float value) {
    Image image = make_image(width, height, format);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                image.set(x, y, c, value);
            }
        }
    }
    return image;
}

Image noise(unsigned seed) {
    std::mt19937 random(seed);
    Image image = make_image(13, 7, PixelFormat::rgba32f);
    for (int i = 0; i < 13 * 7 * 4; ++i) {
        image.set(i / 4 % 13, i / 52, i % 4, static_cast<float>(random() % 1000) / 1000.0F);
    }
    return image;
}

TEST(Compare, IdenticalImagesAreEqualWithNoTolerance) {
    for (const FormatInfo& format : all_formats()) {
        const Image image = filled(3, 2, format.format, 0.5F);
        const CompareResult result = compare(image, image, {});
        EXPECT_TRUE(result.equal) << format.name;
        EXPECT_EQ(result.reason, "");
        EXPECT_EQ(result.max, 0.0);
        EXPECT_EQ(result.psnr_db, std::numeric_limits<double>::infinity());
        EXPECT_EQ(result.worst_x, -1);
    }
}

TEST(Compare, MeasuresAgreeWithTheirDefinitions) {
    const Image a = noise(1);
    const Image b = noise(2);
    const CompareResult result = compare(a, b, {0.5, 1.0, 1.0});
    double sum = 0.0;
    double squares = 0.0;
    double largest = 0.0;
    int over = 0;
    for (int y = 0; y < 7; ++y) {
        for (int x = 0; x < 13; ++x) {
            bool pixel_over = false;
            for (int c = 0; c < 4; ++c) {
                const double d = std::abs(double{a.at(x, y, c)} - double{b.at(x, y, c)});
                sum += d;
                squares += d * d;
                largest = std::max(largest, d);
                pixel_over = pixel_over || d > 0.5;
            }
            over += pixel_over ? 1 : 0;
        }
    }
    EXPECT_DOUBLE_EQ(result.max, largest);
    EXPECT_DOUBLE_EQ(result.mean, sum / 364);
    EXPECT_DOUBLE_EQ(result.rms, std::sqrt(squares / 364));
    EXPECT_NEAR(result.psnr_db, 10.0 * std::log10(364 / squares), 1e-12);
    EXPECT_DOUBLE_EQ(result.fraction, over / 91.0);
    EXPECT_DOUBLE_EQ(std::abs(double{a.at(result.worst_x, result.worst_y, result.worst_channel)} -
                              double{b.at(result.worst_x, result.worst_y, result.worst_channel)}),
                     largest);
    EXPECT_TRUE(result.equal);
}

TEST(Compare, OneWrongChannelOfOnePixelIsFound) {
    const Image a = noise(1);
    Image b = a;
    b.set(12, 6, 3, a.at(12, 6, 3) + 0.25F);
    const CompareResult result = compare(a, b, {0.2, 1.0, 0.0});
    EXPECT_FALSE(result.equal);
    EXPECT_EQ(result.worst_x, 12);
    EXPECT_EQ(result.worst_y, 6) << "row 0 is the bottom";
    EXPECT_EQ(result.worst_channel, 3);
    EXPECT_NEAR(result.max, 0.25, 1e-6);
    EXPECT_THAT(result.reason, HasSubstr("pixel (12, 6) channel 3"));
}

TEST(Compare, EachLimitHoldsOnItsOwnAndIsInclusive) {
    const Image a = filled(4, 1, PixelFormat::r32f, 0.0F);
    Image b = a;
    b.set(1, 0, 0, 0.5F);  // max 0.5, mean 0.125, a quarter of the pixels
    EXPECT_TRUE(compare(a, b, {0.5, 0.125, 0.0}).equal);
    EXPECT_FALSE(compare(a, b, {0.4999, 0.125, 0.0}).equal);
    EXPECT_FALSE(compare(a, b, {0.5, 0.1249, 0.0}).equal);
    EXPECT_THAT(compare(a, b, {0.5, 0.1249, 0.0}).reason, HasSubstr("mean"));
    EXPECT_TRUE(compare(a, b, {0.0, 0.125, 0.25}).equal) << "a quarter may be over";
    EXPECT_FALSE(compare(a, b, {0.0, 0.125, 0.2499}).equal);
    EXPECT_FALSE(compare(a, b, {0.0, 0.1249, 0.25}).equal) << "pixels let pass still count in the mean";
}

TEST(Compare, ASmallBiasEverywhereFailsTheMean) {
    const Image a = filled(8, 8, PixelFormat::rgba32f, 0.25F);
    const Image b = filled(8, 8, PixelFormat::rgba32f, 0.2509765625F);  // + 2^-10
    const CompareResult result = compare(a, b, {0.01, 0.0005, 0.0});
    EXPECT_FALSE(result.equal);
    EXPECT_DOUBLE_EQ(result.mean, 0x1p-10);
    EXPECT_DOUBLE_EQ(result.psnr_db, 20.0 * std::log10(1024.0));
}

TEST(Compare, TheSmallestDifferenceIsSeen) {
    const Image a = filled(2, 2, PixelFormat::r32f, 1.0F);
    Image b = a;
    b.set(0, 1, 0, std::nextafter(1.0F, 2.0F));
    EXPECT_FALSE(compare(a, b, {}).equal);
    EXPECT_FALSE(compare(b, a, {}).equal);
    const Image tiny = filled(1, 1, PixelFormat::r32f, std::numeric_limits<float>::denorm_min());
    EXPECT_FALSE(compare(tiny, filled(1, 1, PixelFormat::r32f, 0.0F), {}).equal);
}

TEST(Compare, LargeValuesDoNotOverflow) {
    const float most = std::numeric_limits<float>::max();
    const CompareResult result =
        compare(filled(1, 1, PixelFormat::r32f, most), filled(1, 1, PixelFormat::r32f, -most), generous);
    EXPECT_DOUBLE_EQ(result.max, 2.0 * double{most});
    EXPECT_TRUE(std::isfinite(result.rms));
    EXPECT_FALSE(result.equal);
}

TEST(Compare, NanAndInfNeverPass) {
    for (const float bad : {nan_float, -nan_float, infinity_float, -infinity_float}) {
        for (const PixelFormat format : {PixelFormat::r32f, PixelFormat::rgba16f, PixelFormat::depth32f}) {
            const Image good = filled(3, 3, format, 0.5F);
            Image spoilt = good;
            spoilt.set(2, 1, 0, bad);
            EXPECT_FALSE(compare(good, spoilt, generous).equal);
            EXPECT_FALSE(compare(spoilt, good, generous).equal);
            EXPECT_FALSE(compare(spoilt, spoilt, generous).equal) << "even the same in both";
            const CompareResult result = compare(spoilt, spoilt, generous);
            EXPECT_EQ(result.nan, std::isnan(bad) ? 2U : 0U);
            EXPECT_EQ(result.inf, std::isinf(bad) ? 2U : 0U);
            EXPECT_DOUBLE_EQ(result.fraction, 1.0 / 9.0);
            EXPECT_TRUE(std::isfinite(result.mean));
        }
    }
    const Image all = filled(2, 2, PixelFormat::r32f, nan_float);
    EXPECT_FALSE(compare(all, all, generous).equal);
}

TEST(Compare, LimitsThatAreNanOrNegativeLetNothingPass) {
    const Image image = noise(3);
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(compare(image, image, {none, 1.0, 0.5}).equal);
    EXPECT_FALSE(compare(image, image, {1.0, none, 1.0}).equal);
    EXPECT_FALSE(compare(image, image, {1.0, 1.0, none}).equal);
    EXPECT_FALSE(compare(image, image, {-1.0, 1.0, 0.0}).equal);
    EXPECT_FALSE(compare(image, image, {1.0, -1.0, 0.0}).equal);
}

TEST(Compare, DifferentShapesAreNotEqual) {
    const Image a = filled(4, 2, PixelFormat::rgba8, 0.0F);
    for (const Image& b : {filled(2, 4, PixelFormat::rgba8, 0.0F), filled(4, 3, PixelFormat::rgba8, 0.0F),
                           filled(4, 2, PixelFormat::rg8, 0.0F), filled(8, 1, PixelFormat::rgba8, 0.0F)}) {
        EXPECT_FALSE(compare(a, b, generous).equal);
        EXPECT_THAT(compare(a, b, generous).reason, HasSubstr("4x2"));
        EXPECT_THROW((void)heatmap(a, b), Error);
    }
    EXPECT_TRUE(compare(a, filled(4, 2, PixelFormat::rgba16f, 0.0F), {}).equal) << "precision may differ";
}

TEST(Compare, EmptyOrTornImagesAreNotEqual) {
    EXPECT_FALSE(compare(Image{}, Image{}, generous).equal);
    EXPECT_FALSE(compare(Image{}, noise(1), generous).equal);
    Image torn = noise(1);
    torn.data.pop_back();
    EXPECT_FALSE(compare(torn, torn, generous).equal);
    EXPECT_FALSE(compare(noise(1), torn, generous).equal);
    EXPECT_THROW((void)heatmap(torn, torn), Error);
}

TEST(Compare, ShiftedMirroredAndSwappedPicturesFail) {
    Image ramp = make_image(8, 8, PixelFormat::rgba8);
    Image shifted = ramp;
    Image flipped = ramp;
    Image swapped = ramp;
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 8; ++x) {
            const float v = static_cast<float>(x + 8 * y) / 64.0F;
            ramp.set(x, y, 0, v);
            shifted.set((x + 1) % 8, y, 0, v);
            flipped.set(x, 7 - y, 0, v);
            swapped.set(x, y, 2, v);
        }
    }
    for (const Image& wrong : {shifted, flipped, swapped}) {
        EXPECT_FALSE(compare(ramp, wrong, {2.0 / 255.0, 1.0, 0.05}).equal);
    }
}

std::array<int, 4> pixel(const Image& image, int x, int y) {
    std::array<int, 4> bytes{};
    for (int c = 0; c < 4; ++c) {
        bytes[static_cast<std::size_t>(c)] = static_cast<int>(std::lround(255.0F * image.at(x, y, c)));
    }
    return bytes;
}

TEST(Heatmap, RunsFromBlackThroughRedAndYellowToWhite) {
    const Image a = filled(6, 2, PixelFormat::rgba32f, 0.0F);
    Image b = a;
    b.set(1, 0, 2, 1.0F);
    b.set(2, 0, 3, -2.0F);
    b.set(3, 0, 0, 3.0F);
    b.set(4, 0, 0, 1e-9F);
    b.set(5, 0, 0, nan_float);
    b.set(0, 1, 1, 6.0F);
    const Image map = heatmap(a, b, 3.0);
    EXPECT_EQ(map.format, PixelFormat::rgba8);
    EXPECT_EQ(pixel(map, 0, 0), (std::array{0, 0, 0, 255}));
    EXPECT_EQ(pixel(map, 1, 0), (std::array{255, 0, 0, 255}));
    EXPECT_EQ(pixel(map, 2, 0), (std::array{255, 255, 0, 255}));
    EXPECT_EQ(pixel(map, 3, 0), (std::array{255, 255, 255, 255}));
    EXPECT_EQ(pixel(map, 4, 0), (std::array{1, 0, 0, 255})) << "the least difference is not black";
    EXPECT_EQ(pixel(map, 5, 0), (std::array{255, 0, 255, 255}));
    EXPECT_EQ(pixel(map, 0, 1), (std::array{255, 255, 255, 255})) << "over the scale";
    EXPECT_EQ(pixel(heatmap(a, b), 3, 0), (std::array{255, 128, 0, 255})) << "half of the largest";
    EXPECT_EQ(pixel(heatmap(a, b), 0, 1), (std::array{255, 255, 255, 255}));
}

TEST(Heatmap, OfIdenticalImagesIsBlack) {
    const Image map = heatmap(noise(1), noise(1));
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            EXPECT_EQ(pixel(map, x, y), (std::array{0, 0, 0, 255}));
        }
    }
}

}  // namespace
}  // namespace viscera

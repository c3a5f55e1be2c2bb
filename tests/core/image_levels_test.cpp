#include "engine/core/image_levels.h"

#include <gtest/gtest.h>

namespace viscera::test {
namespace {

Image ramp(int width, int height, PixelFormat format) {
    Image image = make_image(width, height, format);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                image.set(x, y, c, 0.1F * static_cast<float>((3 * x + 5 * y * y + c) % 11));
            }
        }
    }
    return image;
}

double mean(const Image& image, int c) {
    double sum = 0.0;
    for (int i = 0; i < image.width * image.height; ++i) {
        sum += static_cast<double>(image.at(i % image.width, i / image.width, c));
    }
    return sum / (image.width * image.height);
}

TEST(ImageLevels, HalveUntilOneTexelIsLeft) {
    const std::vector<Image> levels = image_levels(ramp(20, 3, PixelFormat::rg32f));
    ASSERT_EQ(levels.size(), 5U);
    EXPECT_EQ(levels[1].width, 10);
    EXPECT_EQ(levels[1].height, 1);
    EXPECT_EQ(levels[2].width, 5);
    EXPECT_EQ(levels[3].width, 2);
    EXPECT_EQ(levels[4].width, 1);
    EXPECT_EQ(levels[0].data, ramp(20, 3, PixelFormat::rg32f).data) << "the picture itself is as it was";
}

TEST(ImageLevels, AreMeansAlsoOfOddSizes) {
    for (const auto& [width, height] :
         {std::pair(16, 16), std::pair(7, 5), std::pair(1, 9), std::pair(13, 2)}) {
        const std::vector<Image> levels = image_levels(ramp(width, height, PixelFormat::rg32f));
        for (const Image& level : levels) {
            EXPECT_NEAR(mean(level, 0), mean(levels[0], 0), 1e-6) << width << " x " << height;
            EXPECT_NEAR(mean(level, 1), mean(levels[0], 1), 1e-6) << width << " x " << height;
        }
    }
    const Image picture = ramp(8, 8, PixelFormat::r32f);
    const Image half = image_levels(picture)[1];
    EXPECT_NEAR(
        half.at(1, 2, 0),
        0.25F * (picture.at(2, 4, 0) + picture.at(3, 4, 0) + picture.at(2, 5, 0) + picture.at(3, 5, 0)),
        1e-7F);
}

TEST(ImageLevels, AreNotMadeFromRoundedOnes) {
    // 1/255 in one texel of 64: rounded at each level it would be lost at the first.
    Image image = make_image(8, 8, PixelFormat::rgba8);
    for (int i = 0; i < 40; ++i) {
        image.set(i % 8, i / 8, 0, 1.0F / 255.0F);
    }
    EXPECT_EQ(image_levels(image).back().at(0, 0, 0), 1.0F / 255.0F) << "40/64 of it is rounded up";
}

TEST(ImageLevels, OfOneTexelAreIt) {
    EXPECT_EQ(image_levels(ramp(1, 1, PixelFormat::rgba16f)).size(), 1U);
}

}  // namespace
}  // namespace viscera::test

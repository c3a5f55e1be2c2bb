#include "engine/io/png.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string_view>

#include "engine/core/error.h"
#include "engine/io/exr.h"
#include "tests/core/error_of.h"
#include "tests/io/temp_folder.h"

namespace viscera::io {
namespace {

using test::error_of;
using test::TempFolder;

Image gradient(PixelFormat format) {
    Image image = make_image(7, 5, format);
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 7; ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                image.set(x, y, c, static_cast<float>(x + 7 * y + 35 * c) / 255.0F);
            }
        }
    }
    return image;
}

TEST(Png, BytesComeBack) {
    const TempFolder folder;
    for (const PixelFormat format : {PixelFormat::r8, PixelFormat::rgba8}) {
        const Image image = gradient(format);
        write_png(folder / "a.png", image);
        const Image read = read_image(folder / "a.png");
        EXPECT_EQ(read.format, format);
        EXPECT_EQ(read.data, image.data);
    }
}

TEST(Png, SixteenBitsComeBackExactly) {
    const TempFolder folder;
    Image image = make_image(3, 2, PixelFormat::rgba32f);
    for (int i = 0; i < 24; ++i) {
        image.set(i % 3, i / 12, i / 3 % 4, static_cast<float>(i * 2731) / 65535.0F);
    }
    write_png(folder / "a.png", image, {.sixteen_bit = true});
    const Image read = read_image(folder / "a.png");
    EXPECT_EQ(read.format, PixelFormat::rgba32f);
    EXPECT_EQ(read.data, image.data);
}

TEST(Png, ValuesAreClampedAndNanIsBlack) {
    const TempFolder folder;
    Image image = make_image(4, 1, PixelFormat::r32f);
    image.set(0, 0, 0, 1e9F);
    image.set(1, 0, 0, -3.0F);
    image.set(2, 0, 0, std::numeric_limits<float>::quiet_NaN());
    image.set(3, 0, 0, std::numeric_limits<float>::infinity());
    write_png(folder / "a.png", image);
    const Image read = read_image(folder / "a.png");
    EXPECT_EQ(to_floats(read), (std::vector<float>{1.0F, 0.0F, 0.0F, 1.0F}));
}

TEST(Png, SrgbIsForColourOnlyAndOnlyOnDemand) {
    const TempFolder folder;
    Image image = make_image(1, 1, PixelFormat::rgba32f);
    for (int c = 0; c < 4; ++c) {
        image.set(0, 0, c, 0.5F);
    }
    write_png(folder / "a.png", image, {.srgb = true});
    const Image encoded = read_image(folder / "a.png");
    EXPECT_EQ(encoded.at(0, 0, 0), 188.0F / 255.0F);  // sRGB of 0.5 is 0.7354
    EXPECT_EQ(encoded.at(0, 0, 3), 128.0F / 255.0F);
    write_png(folder / "a.png", image);
    EXPECT_EQ(read_image(folder / "a.png").at(0, 0, 0), 128.0F / 255.0F);
}

TEST(Png, TwoChannelsAreRedAndGreenAndAlphaCanBeLeftOut) {
    const TempFolder folder;
    const Image two = gradient(PixelFormat::rg8);
    write_png(folder / "a.png", two);
    Image read = read_image(folder / "a.png");
    EXPECT_EQ(read.at(6, 4, 1), two.at(6, 4, 1));
    EXPECT_EQ(read.at(6, 4, 2), 0.0F);
    EXPECT_EQ(read.at(6, 4, 3), 1.0F);
    write_png(folder / "a.png", gradient(PixelFormat::rgba8), {.alpha = false});
    read = read_image(folder / "a.png");
    EXPECT_EQ(read.at(0, 0, 3), 1.0F);
    EXPECT_EQ(read.at(0, 0, 2), 70.0F / 255.0F);
}

TEST(Png, BadFilesAndFoldersAreFileErrors) {
    const TempFolder folder;
    const auto code = [](const auto& action) {
        try {
            action();
        } catch (const Error& error) {
            return error.code();
        }
        return ErrorCode::gl;
    };
    const auto read = [&](const std::filesystem::path& file) {
        return code([&] { static_cast<void>(read_image(file)); });
    };
    EXPECT_EQ(read(folder / "none.png"), ErrorCode::file);
    EXPECT_EQ(read(folder.write("empty.png", "")), ErrorCode::file);
    EXPECT_EQ(read(folder.write("text.jpg", "no picture")), ErrorCode::file);
    EXPECT_EQ(read(folder.write("a.bmp", "BM")), ErrorCode::file);
    EXPECT_EQ(code([&] { write_png(folder / "none/a.png", gradient(PixelFormat::r8)); }), ErrorCode::file);
    EXPECT_EQ(code([&] { write_png(folder / "a.png", Image{}); }), ErrorCode::usage);
}

TEST(Png, WhatTheLibraryRefusesIsAnErrorWithItsWords) {
    const TempFolder folder;
    const Image wide = make_image(1'000'001, 1, PixelFormat::r8);
    const auto error = error_of([&] { write_png(folder / "wide.png", wide); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::file);
    EXPECT_THAT(error->what(), testing::HasSubstr("cannot be encoded: Invalid IHDR data"));
    EXPECT_FALSE(std::filesystem::exists(folder / "wide.png"));
}

TEST(ReadImage, ExrGivesItsFirstPicture) {
    const TempFolder folder;
    const ExrPart part{"a", gradient(PixelFormat::rgba16f), {}, {}};
    write_exr(folder / "A.EXR", {&part, 1});
    EXPECT_EQ(read_image(folder / "A.EXR").data, part.image.data);
}

}  // namespace
}  // namespace viscera::io

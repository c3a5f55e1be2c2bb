#include "engine/io/exr.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "engine/core/error.h"
#include "tests/io/temp_folder.h"

namespace viscera::io {
namespace {

using test::TempFolder;

Image noise(int width, int height, PixelFormat format, unsigned seed) {
    Image image = make_image(width, height, format);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> values(0.0F, 1.0F);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < image.channels(); ++c) {
                image.set(x, y, c, values(random));
            }
        }
    }
    return image;
}

ErrorCode code_of(const auto& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.code();
    }
    ADD_FAILURE() << "nothing was thrown";
    return ErrorCode::gl;
}

TEST(Exr, EveryFormatComesBackBitForBit) {
    const TempFolder folder;
    for (const FormatInfo& format : all_formats()) {
        if (format.type == ChannelType::unorm8) {
            continue;
        }
        for (const ExrCompression compression :
             {ExrCompression::none, ExrCompression::zips, ExrCompression::zip, ExrCompression::piz}) {
            const ExrPart part{"contrast.main", noise(13, 37, format.format, 1), {}, {}};
            write_exr(folder / "a.exr", {&part, 1}, compression);
            const std::vector<ExrPart> read = read_exr(folder / "a.exr");
            ASSERT_EQ(read.size(), 1U) << format.name;
            EXPECT_EQ(read[0].name, "contrast.main");
            EXPECT_EQ(read[0].image.format, format.format);
            EXPECT_EQ(read[0].image.width, 13);
            EXPECT_EQ(read[0].image.height, 37);
            EXPECT_EQ(read[0].image.data, part.image.data) << format.name;
            EXPECT_EQ(read[0].channels, default_channel_names(format.format));
            EXPECT_EQ(read[0].compression, choice_names(compression)[static_cast<std::size_t>(compression)]);
        }
    }
}

TEST(Exr, BytesComeBackThroughHalf) {
    const TempFolder folder;
    Image bytes = make_image(256, 1, PixelFormat::r8);
    for (std::size_t n = 0; n < 256; ++n) {
        bytes.data[n] = static_cast<std::byte>(n);
    }
    const ExrPart part{"mask", bytes, {}, {}};
    write_exr(folder / "a.exr", {&part, 1});
    const Image half = read_exr(folder / "a.exr").at(0).image;
    ASSERT_EQ(half.format, PixelFormat::r16f);
    Image again = make_image(256, 1, PixelFormat::r8);
    for (int n = 0; n < 256; ++n) {
        again.set(n, 0, 0, half.at(n, 0, 0));
    }
    EXPECT_EQ(again.data, bytes.data);
}

TEST(Exr, NotFiniteValuesStay) {
    const TempFolder folder;
    Image image = make_image(2, 1, PixelFormat::r16f);
    image.set(0, 0, 0, std::numeric_limits<float>::quiet_NaN());
    image.set(1, 0, 0, -std::numeric_limits<float>::infinity());
    const ExrPart part{"a", image, {}, {}};
    write_exr(folder / "a.exr", {&part, 1});
    EXPECT_EQ(read_exr(folder / "a.exr").at(0).image.data, image.data);
}

TEST(Exr, DwaaIsNearForColour) {
    const TempFolder folder;
    Image image = make_image(64, 64, PixelFormat::rgba16f);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            for (int c = 0; c < 4; ++c) {
                image.set(x, y, c, static_cast<float>(x + y) / 126.0F);
            }
        }
    }
    const ExrPart part{"final", image, {}, {}};
    write_exr(folder / "a.exr", {&part, 1}, ExrCompression::dwaa);
    const ExrPart read = read_exr(folder / "a.exr").at(0);
    EXPECT_EQ(read.compression, "dwaa");
    for (int x = 0; x < 64; ++x) {
        EXPECT_NEAR(read.image.at(x, 31, 0), image.at(x, 31, 0), 0.01F);
        EXPECT_EQ(read.image.at(x, 31, 3), image.at(x, 31, 3));  // alpha is packed without loss
    }
}

TEST(Exr, FirstRowOfTheFileIsTheTop) {
    const TempFolder folder;
    Image image = make_image(1, 3, PixelFormat::r32f);
    image.set(0, 0, 0, 10.0F);  // bottom
    image.set(0, 2, 0, 30.0F);  // top
    const ExrPart part{"", image, {}, {}};
    write_exr(folder / "a.exr", {&part, 1}, ExrCompression::none);
    // Without packing each row ends the file in turn as 8 bytes of y and size and 4 of value.
    const std::string bytes = test::slurp(folder / "a.exr");
    const auto value_at = [&](std::size_t row_from_end) {
        float value = 0.0F;
        std::memcpy(&value, bytes.data() + bytes.size() - 12 * row_from_end + 8, sizeof value);
        return value;
    };
    EXPECT_EQ(value_at(3), 30.0F);
    EXPECT_EQ(value_at(1), 10.0F);
}

TEST(Exr, PartsKeepNamesChannelsAndAttributes) {
    const TempFolder folder;
    const std::vector<ExrAttribute> attributes{{"viscera:scene_hash", "0123456789abcdef"},
                                               {"viscera:time_s", 1.5F}};
    const std::vector<ExrPart> parts{
        {"contrast.main", noise(8, 4, PixelFormat::r16f, 1), {}, attributes},
        {"contrast.cloud", noise(5, 9, PixelFormat::rg32f, 2), {"brightness", "weight"}, {{"note", "äö"}}},
        {"depth", noise(8, 4, PixelFormat::depth32f, 3), {}, {}},
        {"final", noise(8, 4, PixelFormat::rgba8, 4), {}, {}}};
    write_exr(folder / "all.exr", parts, ExrCompression::zip);
    const std::vector<ExrPart> read = read_exr(folder / "all.exr");
    ASSERT_EQ(read.size(), 5U);  // two channels of other names are two pictures
    EXPECT_EQ(read[0].name, "contrast.main");
    EXPECT_EQ(read[0].image.data, parts[0].image.data);
    EXPECT_EQ(read[0].attributes, attributes);
    EXPECT_EQ(read[1].name, "contrast.cloud.brightness");
    EXPECT_EQ(read[2].name, "contrast.cloud.weight");
    EXPECT_EQ(read[1].image.at(4, 8, 0), parts[1].image.at(4, 8, 0));
    EXPECT_EQ(read[2].image.at(3, 2, 0), parts[1].image.at(3, 2, 1));
    EXPECT_EQ(read[1].attributes, parts[1].attributes);
    EXPECT_EQ(read[3].image.format, PixelFormat::depth32f);
    EXPECT_EQ(read[4].name, "final");
    EXPECT_EQ(read[4].image.format, PixelFormat::rgba16f);
}

TEST(Exr, BadPartsAreTheCallersFault) {
    const TempFolder folder;
    const Image image = noise(2, 2, PixelFormat::rg16f, 1);
    const auto write = [&](std::vector<ExrPart> parts) {
        return code_of([&] { write_exr(folder / "a.exr", parts); });
    };
    EXPECT_EQ(write({}), ErrorCode::usage);
    EXPECT_EQ(write({{"a", Image{}, {}, {}}}), ErrorCode::usage);
    EXPECT_EQ(write({{"a", image, {"R"}, {}}}), ErrorCode::usage);
    EXPECT_EQ(write({{"a", image, {"R", "R"}, {}}}), ErrorCode::usage);
    EXPECT_EQ(write({{"a", image, {}, {}}, {"a", image, {}, {}}}), ErrorCode::usage);
    EXPECT_EQ(write({{"", image, {}, {}}, {"b", image, {}, {}}}), ErrorCode::usage);
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(Exr, AFolderThatIsMissingOrRefusesIsAFileError) {
    const TempFolder folder;
    const ExrPart part{"a", noise(2, 2, PixelFormat::r16f, 1), {}, {}};
    EXPECT_EQ(code_of([&] { write_exr(folder / "none/a.exr", {&part, 1}); }), ErrorCode::file);
    EXPECT_EQ(code_of([&] { write_exr("/proc/a.exr", {&part, 1}); }), ErrorCode::file);
    std::filesystem::create_directory(folder / "taken.exr");
    EXPECT_EQ(code_of([&] { write_exr(folder / "taken.exr", {&part, 1}); }), ErrorCode::file);
    EXPECT_EQ(folder.entries(), 1U);
    EXPECT_EQ(code_of([&] { static_cast<void>(read_exr(folder / "none.exr")); }), ErrorCode::file);
    EXPECT_EQ(code_of([&] { static_cast<void>(read_exr(folder.path())); }), ErrorCode::file);
}

/// Lets no file grow beyond a size, as a full disk does, while it lives.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        ::signal(SIGXFSZ, handler_);
    }

  private:
    void (*handler_)(int);
    rlimit before_{};
};

TEST(Exr, AFullDiskLeavesTheOldFileAndNothingElse) {
    const TempFolder folder;
    const ExrPart part{"a", noise(200, 200, PixelFormat::r32f, 1), {}, {}};
    static_cast<void>(folder.write("a.exr", "old"));
    {
        const FileSizeLimit limit(4096);
        EXPECT_EQ(code_of([&] { write_exr(folder / "a.exr", {&part, 1}); }), ErrorCode::file);
        EXPECT_EQ(code_of([&] { write_exr(folder / "b.exr", {&part, 1}); }), ErrorCode::file);
    }
    EXPECT_EQ(test::slurp(folder / "a.exr"), "old");
    EXPECT_EQ(folder.entries(), 1U);
    write_exr(folder / "a.exr", {&part, 1});
    EXPECT_EQ(read_exr(folder / "a.exr").at(0).image.data, part.image.data);
    EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace
}  // namespace viscera::io

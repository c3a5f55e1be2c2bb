#include <gtest/gtest.h>

#include <tiffio.h>

#include <random>

#include "engine/core/error.h"
#include "engine/io/volume.h"
#include "tests/io/sample_files.h"
#include "tests/io/temp_folder.h"

namespace viscera::io {
namespace {

using test::TempFolder;

/// How a TIFF file is stored; the picture is the same.
struct Layout {
    int bits = 8;
    int channels = 1;
    bool apart = false;
    int tile = 0;         ///< side of the tiles; 0: rows
    bool turned = false;  ///< the other byte order
    std::uint16_t compression = COMPRESSION_LZW;
};

constexpr int width = 37;  // no multiple of a tile's side
constexpr int height = 21;

int sample(const Layout& layout, int x, int y, int channel) {
    const int n = 7 * x + 131 * y + 1009 * channel;
    return layout.bits == 8 ? n % 256 : (n * 13) % 65536;
}

void write_tiff(const std::filesystem::path& file, const Layout& layout) {
    TIFF* tiff = TIFFOpen(file.c_str(), layout.turned ? "wb" : "wl");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, layout.bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, layout.channels);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, layout.apart ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, layout.channels >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, layout.compression);
    const int planes = layout.apart ? layout.channels : 1;
    const int tile_width = layout.tile > 0 ? layout.tile : width;
    const int tile_height = layout.tile > 0 ? layout.tile : 1;
    if (layout.tile > 0) {
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, layout.tile);
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, layout.tile);
    } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 4);
    }
    for (int plane = 0; plane < planes; ++plane) {
        for (int top = 0; top < height; top += tile_height) {
            for (int left = 0; left < width; left += tile_width) {
                std::string bytes;
                for (int y = top; y < top + tile_height; ++y) {
                    for (int x = left; x < left + tile_width; ++x) {
                        for (int c = 0; c < layout.channels / planes; ++c) {
                            const int value = sample(layout, x, y, layout.apart ? plane : c);
                            bytes += layout.bits == 8 ? test::bytes_of(static_cast<std::uint8_t>(value))
                                                      : test::bytes_of(static_cast<std::uint16_t>(value));
                        }
                    }
                }
                const auto x = static_cast<std::uint32_t>(left);
                const auto y = static_cast<std::uint32_t>(top);
                const auto s = static_cast<std::uint16_t>(plane);
                ASSERT_GE(layout.tile > 0 ? static_cast<int>(TIFFWriteTile(tiff, bytes.data(), x, y, 0, s))
                                          : TIFFWriteScanline(tiff, bytes.data(), y, s),
                          0);
            }
        }
    }
    TIFFClose(tiff);
}

TEST(VolumeTiff, EveryLayoutHoldsTheSamePicture) {
    for (const int bits : {8, 16}) {
        for (const int channels : {1, 3}) {
            for (const int tile : {0, 16, 64}) {
                for (const bool apart : {false, true}) {
                    const Layout layout{.bits = bits,
                                        .channels = channels,
                                        .apart = apart,
                                        .tile = tile,
                                        .turned = apart,
                                        .compression = static_cast<std::uint16_t>(
                                            apart ? COMPRESSION_ADOBE_DEFLATE : COMPRESSION_LZW)};
                    SCOPED_TRACE(testing::Message() << bits << " bits, " << channels << " channels, tile "
                                                    << tile << (apart ? ", apart" : ""));
                    const TempFolder folder;
                    for (const char* name : {"a1.tif", "a2.tif"}) {
                        write_tiff(folder / name, layout);
                    }
                    Log log;
                    const Volume volume = load_volume(folder.path(), {}, log);
                    ASSERT_EQ(volume.grid.dims, glm::ivec3(width, height, 2));
                    ASSERT_EQ(volume.channels, channels);
                    ASSERT_EQ(volume.type, bits == 8 ? ScalarType::u8 : ScalarType::u16);
                    int wrong = 0;
                    for (int y = 0; y < height; ++y) {
                        for (int x = 0; x < width; ++x) {
                            for (int c = 0; c < channels; ++c) {
                                wrong += volume.stored({x, y, 1}, c) != sample(layout, x, y, c) ? 1 : 0;
                            }
                        }
                    }
                    EXPECT_EQ(wrong, 0);
                }
            }
        }
    }
}

/// Four pixels with the numbers 0, 1, 2, 255.
void write_palette(const std::filesystem::path& file, const std::array<std::uint16_t, 3>& last,
                   unsigned step) {
    std::array<std::array<std::uint16_t, 256>, 3> palette{};
    for (std::size_t c = 0; c < 3; ++c) {
        palette[c][1] = static_cast<std::uint16_t>(10 * step);
        palette[c][2] = static_cast<std::uint16_t>(20 * step);
        palette[c][255] = static_cast<std::uint16_t>(last[c] * step);
    }
    TIFF* tiff = TIFFOpen(file.c_str(), "w");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 4);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 1);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_PALETTE);
    TIFFSetField(tiff, TIFFTAG_COLORMAP, palette[0].data(), palette[1].data(), palette[2].data());
    std::array<std::uint8_t, 4> row{0, 1, 2, 255};
    ASSERT_EQ(TIFFWriteScanline(tiff, row.data(), 0, 0), 1);
    TIFFClose(tiff);
}

TEST(VolumeTiff, APaletteBecomesItsColours) {
    for (const unsigned step : {1U, 256U, 257U}) {  // as 8 bits, and two ways to 16
        SCOPED_TRACE(step);
        const TempFolder folder;
        Log log;
        write_palette(folder / "a.tif", {250, 100, 50}, step);
        const Volume coloured = load_volume(folder.path(), {}, log);
        ASSERT_EQ(coloured.grid.dims, glm::ivec3(4, 1, 1));
        ASSERT_EQ(coloured.channels, 3);
        EXPECT_EQ(coloured.stored({0, 0, 0}, 2), 0.0);
        EXPECT_EQ(coloured.stored({2, 0, 0}, 1), 20.0);
        EXPECT_EQ(coloured.stored({3, 0, 0}, 0), 250.0);
        EXPECT_EQ(coloured.stored({3, 0, 0}, 2), 50.0);
        write_palette(folder / "a.tif", {90, 90, 90}, step);
        const Volume grey = load_volume(folder.path(), {}, log);
        ASSERT_EQ(grey.channels, 1);
        EXPECT_EQ(grey.stored({3, 0, 0}, 0), 90.0);
    }
}

/// Cut short, or with other bytes: a sound volume or an error that names the folder.
TEST(VolumeTiff, DamagedTilesAreSurvived) {
    const TempFolder folder;
    write_tiff(folder / "a.tif", {.channels = 3, .apart = true, .tile = 16});
    const std::string whole = test::slurp(folder / "a.tif");
    std::mt19937 random(20240607U);
    std::uniform_int_distribution<std::size_t> place(0, whole.size() - 1);
    std::uniform_int_distribution<int> value(0, 255);
    int refused = 0;
    for (int round = 0; round < 200; ++round) {
        std::string bytes = whole;
        if (round % 4 == 0) {
            bytes.resize(place(random));
        }
        for (int flips = 0; flips <= round % 4 && !bytes.empty(); ++flips) {
            // Every other one in the last kilobyte, where the directory is.
            const std::size_t far = place(random) % std::min<std::size_t>(bytes.size(), 1024);
            const std::size_t at = round % 2 == 0 ? bytes.size() - 1 - far : place(random) % bytes.size();
            bytes[at] = static_cast<char>(value(random));
        }
        static_cast<void>(folder.write("a.tif", bytes));
        Log log;
        try {
            const Volume volume = load_volume(folder.path(), {.memory_limit = std::uint64_t{64} << 20U}, log);
            EXPECT_NO_THROW(volume.validate());
        } catch (const Error& error) {
            EXPECT_TRUE(error.code() == ErrorCode::file || error.code() == ErrorCode::limit) << error.what();
            EXPECT_EQ(error.where(), folder.path().string());
            ++refused;
        }
    }
    EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace viscera::io

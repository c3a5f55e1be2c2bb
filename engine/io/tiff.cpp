#include "engine/io/tiff.h"

#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <memory>
#include <span>
#include <string>

#include "engine/core/error.h"

namespace viscera::io {

namespace {

struct Close {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
    void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
};

/// What libtiff says. Of a fixed size, since no exception may pass through it, which is C.
using Message = std::array<char, 200>;

/// Keeps the first message; 1: it goes no further, not to the standard error stream.
int keep(TIFF*, void* text, const char*, const char* format, va_list arguments) {
    auto& message = *static_cast<Message*>(text);
    if (message[0] == '\0') {
        (void)std::vsnprintf(message.data(), message.size(), format, arguments);
    }
    return 1;
}

int ignore(TIFF*, void*, const char*, const char*, va_list) {
    return 1;
}

class Reader {
  public:
    explicit Reader(const std::filesystem::path& file) : file_(file) {
        const std::unique_ptr<TIFFOpenOptions, Close> options(TIFFOpenOptionsAlloc());
        constexpr tmsize_t most_bytes = tmsize_t{1} << 30U;
        TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), most_bytes);
        TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep, &message_);
        TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore, nullptr);
        tiff_.reset(TIFFOpenExt(file.c_str(), "r", options.get()));
        if (!tiff_) {
            fail("is no readable picture");
        }
    }

    [[nodiscard]] TiffPicture read() {
        TiffPicture picture;
        picture.width = static_cast<int>(field<std::uint32_t>(TIFFTAG_IMAGEWIDTH) & 0x7fffffffU);
        picture.height = static_cast<int>(field<std::uint32_t>(TIFFTAG_IMAGELENGTH) & 0x7fffffffU);
        picture.bits = field<std::uint16_t>(TIFFTAG_BITSPERSAMPLE);
        picture.channels = field<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL);
        check(picture);
        const bool apart =
            picture.channels > 1 && field<std::uint16_t>(TIFFTAG_PLANARCONFIG) == PLANARCONFIG_SEPARATE;
        const int planes = apart ? picture.channels : 1;
        pixel_ = static_cast<std::size_t>(picture.channels) * static_cast<std::size_t>(picture.bits / 8);
        piece_ = pixel_ / static_cast<std::size_t>(planes);
        const Part all{0, 0, static_cast<std::size_t>(picture.width),
                       static_cast<std::size_t>(picture.height)};
        expect_packed(all.width * all.height * pixel_);
        picture.bytes.resize(all.width * all.height * pixel_);
        for (int plane = 0; plane < planes; ++plane) {
            if (TIFFIsTiled(tiff_.get()) != 0) {
                read_tiles(picture, all, plane);
            } else {
                read_rows(picture, all, plane);
            }
        }
        if (field<std::uint16_t>(TIFFTAG_PHOTOMETRIC) == PHOTOMETRIC_MINISWHITE) {
            for (std::byte& byte : picture.bytes) {
                byte = ~byte;
            }
        }
        return has_palette() ? with_colours(picture) : picture;
    }

  private:
    template <class T>
    [[nodiscard]] T field(std::uint32_t tag) const {
        T value{};
        TIFFGetFieldDefaulted(tiff_.get(), tag, &value);
        return value;
    }

    [[nodiscard]] bool has_palette() const {
        return field<std::uint16_t>(TIFFTAG_PHOTOMETRIC) == PHOTOMETRIC_PALETTE;
    }

    /// The colours that the numbers of a palette stand for.
    [[nodiscard]] TiffPicture with_colours(const TiffPicture& numbers) const {
        constexpr std::size_t entries = 256;
        std::array<const std::uint16_t*, 3> palette{};
        if (TIFFGetField(tiff_.get(), TIFFTAG_COLORMAP, &palette[0], &palette[1], &palette[2]) == 0) {
            fail("has a palette without colours");
        }
        // Colours have 16 bits; some programs write those of 8 bits as they are.
        const bool narrow = std::ranges::all_of(palette, [](const std::uint16_t* channel) {
            return std::ranges::max(std::span(channel, entries)) < 256;
        });
        TiffPicture picture{numbers.width, numbers.height, 8, 3, {}};
        picture.bytes.reserve(3 * numbers.bytes.size());
        for (const std::byte number : numbers.bytes) {
            for (const std::uint16_t* channel : palette) {
                const unsigned colour = channel[std::to_integer<std::size_t>(number)];
                picture.bytes.push_back(static_cast<std::byte>(narrow ? colour : colour >> 8U));
            }
        }
        return picture;
    }

    /// A rectangle of the picture [pixels].
    struct Part {
        std::size_t x = 0;
        std::size_t y = 0;
        std::size_t width = 0;
        std::size_t height = 0;
    };

    /// No compression makes less of them.
    void expect_packed(std::size_t bytes) const {
        constexpr std::size_t best_compression = 4096;
        if (bytes / best_compression > std::filesystem::file_size(file_)) {
            fail("lies about its size");
        }
    }

    void read_rows(TiffPicture& picture, const Part& all, int plane) const {
        std::vector<std::byte> row(all.width * piece_);
        if (TIFFScanlineSize64(tiff_.get()) != row.size()) {
            fail("lies about its size");
        }
        for (std::size_t y = 0; y < all.height; ++y) {
            if (TIFFReadScanline(tiff_.get(), row.data(), static_cast<std::uint32_t>(y),
                                 static_cast<std::uint16_t>(plane)) < 0) {
                fail("is damaged");
            }
            put(picture, {0, y, all.width, 1}, plane, row, all.width);
        }
    }

    /// Tiles are all of one size and go on beyond the right and the lower edge.
    void read_tiles(TiffPicture& picture, const Part& all, int plane) const {
        const std::size_t width = field<std::uint32_t>(TIFFTAG_TILEWIDTH);
        const std::size_t height = field<std::uint32_t>(TIFFTAG_TILELENGTH);
        constexpr std::size_t most_side = std::size_t{1} << 20U;
        if (width < 1 || height < 1 || width > most_side || height > most_side ||
            TIFFTileSize64(tiff_.get()) != width * height * piece_) {
            fail("lies about the size of its tiles");
        }
        expect_packed(width * height * piece_);
        std::vector<std::byte> tile(width * height * piece_);
        for (std::size_t y = 0; y < all.height; y += height) {
            for (std::size_t x = 0; x < all.width; x += width) {
                if (TIFFReadTile(tiff_.get(), tile.data(), static_cast<std::uint32_t>(x),
                                 static_cast<std::uint32_t>(y), 0, static_cast<std::uint16_t>(plane)) < 0) {
                    fail("is damaged");
                }
                put(picture, {x, y, std::min(width, all.width - x), std::min(height, all.height - y)}, plane,
                    tile, width);
            }
        }
    }

    /// `stride`: pixels from row to row of what was read.
    void put(TiffPicture& picture, const Part& part, int plane, std::span<const std::byte> from,
             std::size_t stride) const {
        for (std::size_t y = 0; y < part.height; ++y) {
            const std::byte* pixel = from.data() + y * stride * piece_;
            std::byte* to = picture.bytes.data() +
                            ((part.y + y) * static_cast<std::size_t>(picture.width) + part.x) * pixel_ +
                            static_cast<std::size_t>(plane) * piece_;
            if (piece_ == pixel_) {
                std::copy_n(pixel, part.width * pixel_, to);
                continue;
            }
            for (std::size_t x = 0; x < part.width; ++x) {
                std::copy_n(pixel + x * piece_, piece_, to + x * pixel_);
            }
        }
    }

    void check(const TiffPicture& picture) const {
        if (picture.width < 1 || picture.height < 1) {
            fail("has no pixels");
        }
        if ((picture.bits != 8 && picture.bits != 16) || picture.channels < 1 || picture.channels > 4 ||
            field<std::uint16_t>(TIFFTAG_SAMPLEFORMAT) != SAMPLEFORMAT_UINT) {
            fail("has pixels that are not read: 1 to 4 unsigned channels of 8 or 16 bits are");
        }
        if (has_palette() && (picture.bits != 8 || picture.channels != 1)) {
            fail("has a palette that is not read: one of 256 colours is");
        }
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::file, file_.string(),
                    what + (message_[0] == '\0' ? "" : std::string(": ") + message_.data()));
    }

    std::filesystem::path file_;
    Message message_{};
    std::size_t pixel_ = 1;  ///< bytes of all channels of a pixel
    std::size_t piece_ = 1;  ///< of those that lie beside each other in the file
    std::unique_ptr<TIFF, Close> tiff_;
};

}  // namespace

TiffPicture read_tiff(const std::filesystem::path& file) {
    return Reader(file).read();
}

}  // namespace viscera::io

#include "engine/io/tiff.h"

#include <tiffio.h>

#include <array>
#include <cstdarg>
#include <cstdio>
#include <memory>
#include <string>

#include "engine/core/error.h"

namespace viscera::io {

namespace {

struct Close {
    void operator()(TIFF* tiff) const { TIFFClose(tiff); }
    void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
};

/// Keeps the first message; 1: it goes no further, not to the standard error stream.
int keep(TIFF*, void* text, const char*, const char* format, va_list arguments) {
    std::array<char, 200> buffer{};
    auto& message = *static_cast<std::string*>(text);
    if (message.empty() && std::vsnprintf(buffer.data(), buffer.size(), format, arguments) > 0) {
        message = buffer.data();
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
        const auto row = static_cast<std::size_t>(picture.width) *
                         static_cast<std::size_t>(picture.channels) *
                         static_cast<std::size_t>(picture.bits / 8);
        const auto rows = static_cast<std::size_t>(picture.height);
        constexpr std::size_t best_compression = 4096;
        if (row * rows / best_compression > std::filesystem::file_size(file_) ||
            static_cast<std::size_t>(TIFFScanlineSize64(tiff_.get())) != row) {
            fail("lies about its size");
        }
        picture.bytes.resize(row * rows);
        for (std::size_t y = 0; y < rows; ++y) {
            if (TIFFReadScanline(tiff_.get(), picture.bytes.data() + y * row, static_cast<std::uint32_t>(y)) <
                0) {
                fail("is damaged");
            }
        }
        if (field<std::uint16_t>(TIFFTAG_PHOTOMETRIC) == PHOTOMETRIC_MINISWHITE) {
            for (std::byte& byte : picture.bytes) {
                byte = ~byte;
            }
        }
        return picture;
    }

  private:
    template <class T>
    [[nodiscard]] T field(std::uint32_t tag) const {
        T value{};
        TIFFGetFieldDefaulted(tiff_.get(), tag, &value);
        return value;
    }

    void check(const TiffPicture& picture) const {
        if (picture.width < 1 || picture.height < 1) {
            fail("has no pixels");
        }
        if ((picture.bits != 8 && picture.bits != 16) || picture.channels < 1 || picture.channels > 4 ||
            field<std::uint16_t>(TIFFTAG_SAMPLEFORMAT) != SAMPLEFORMAT_UINT) {
            fail("has pixels that are not read: 1 to 4 unsigned channels of 8 or 16 bits are");
        }
        if (TIFFIsTiled(tiff_.get()) != 0) {
            fail("is stored in tiles; only strips are read");
        }
        if (picture.channels > 1 && field<std::uint16_t>(TIFFTAG_PLANARCONFIG) != PLANARCONFIG_CONTIG) {
            fail("has its channels apart; only interleaved ones are read");
        }
        if (field<std::uint16_t>(TIFFTAG_PHOTOMETRIC) == PHOTOMETRIC_PALETTE) {
            fail("has a palette, which is not read");
        }
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::file, file_.string(), what + (message_.empty() ? "" : ": " + message_));
    }

    std::filesystem::path file_;
    std::string message_;
    std::unique_ptr<TIFF, Close> tiff_;
};

}  // namespace

TiffPicture read_tiff(const std::filesystem::path& file) {
    return Reader(file).read();
}

}  // namespace viscera::io

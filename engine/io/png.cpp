#include "engine/io/png.h"

#include <png.h>

#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"

namespace viscera::io {

namespace {

/// IEC 61966-2-1.
float encode_srgb(float linear) {
    return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
}

float clamp01(float value) {
    return value > 0.0F ? std::fmin(value, 1.0F) : 0.0F;
}

/// What of an Image becomes which PNG channels.
struct ChannelLayout {
    int channels = 1;  ///< of the PNG: 1, 3 or 4
    int colour_type = PNG_COLOR_TYPE_GRAY;
};

ChannelLayout layout_of(const Image& image, const PngOptions& options) {
    if (image.channels() == 1) {
        return {1, PNG_COLOR_TYPE_GRAY};
    }
    if (image.channels() == 4 && options.alpha) {
        return {4, PNG_COLOR_TYPE_RGB_ALPHA};
    }
    return {3, PNG_COLOR_TYPE_RGB};
}

/// Samples of the picture, top row first, 16-bit ones in PNG's big-endian order.
std::vector<png_byte> samples_of(const Image& image, const PngOptions& options, int channels) {
    const float most = options.sixteen_bit ? 65535.0F : 255.0F;
    std::vector<png_byte> samples;
    samples.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) *
                    static_cast<std::size_t>(channels) * (options.sixteen_bit ? 2 : 1));
    for (int y = image.height - 1; y >= 0; --y) {
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < channels; ++c) {
                const float linear = c < image.channels() ? clamp01(image.at(x, y, c)) : 0.0F;
                const float value = options.srgb && c < 3 ? encode_srgb(linear) : linear;
                const auto sample = static_cast<unsigned>(std::lround(value * most));
                if (options.sixteen_bit) {
                    samples.push_back(static_cast<png_byte>(sample >> 8U));
                }
                samples.push_back(static_cast<png_byte>(sample & 0xFFU));
            }
        }
    }
    return samples;
}

// libpng is C: no exception may pass through it, so errors leave it as it wants them to, by longjmp.

/// What is written, and why it could not be.
struct Output {
    std::string bytes;
    std::array<char, 100> error{};
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
    auto& error = static_cast<Output*>(png_get_error_ptr(png))->error;
    std::snprintf(error.data(), error.size(), "%s", message);
    png_longjmp(png, 1);
}
void on_warning(png_structp, png_const_charp) {}

void append(png_structp png, png_bytep bytes, png_size_t count) {
    bool done = false;
    try {
        static_cast<Output*>(png_get_io_ptr(png))->bytes.append(reinterpret_cast<const char*>(bytes), count);
        done = true;
    } catch (const std::exception&) {
    }
    if (!done) {
        png_error(png, "no memory");
    }
}
void flush(png_structp) {}

/// Frees libpng's structures however the scope is left.
class Writer {
  public:
    explicit Writer(Output& output)
        : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, &output, on_error, on_warning)),
          info_(png_ != nullptr ? png_create_info_struct(png_) : nullptr) {
        if (info_ == nullptr) {
            throw std::runtime_error("libpng cannot start");
        }
    }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    ~Writer() { png_destroy_write_struct(&png_, &info_); }

    [[nodiscard]] png_structp png() const { return png_; }
    [[nodiscard]] png_infop info() const { return info_; }

  private:
    png_structp png_;
    png_infop info_;
};

/// False where libpng reports an error. Nothing here needs a destructor, which longjmp would leave out.
bool write(png_structp png, png_infop info, png_uint_32 width, png_uint_32 height, int bits, int colour_type,
           std::span<const png_byte> samples) {
    if (setjmp(png_jmpbuf(png)) != 0) {
        return false;
    }
    png_set_IHDR(png, info, width, height, bits, colour_type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    const std::size_t row_bytes = samples.size() / height;
    for (std::size_t y = 0; y < height; ++y) {
        png_write_row(png, samples.data() + y * row_bytes);
    }
    png_write_end(png, info);
    return true;
}

std::string encode_png(const Image& image, const PngOptions& options) {
    const ChannelLayout layout = layout_of(image, options);
    const std::vector<png_byte> samples = samples_of(image, options, layout.channels);
    Output output;
    const Writer writer(output);
    png_set_write_fn(writer.png(), &output, append, flush);
    if (!write(writer.png(), writer.info(), static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), options.sixteen_bit ? 16 : 8, layout.colour_type,
               samples)) {
        throw std::runtime_error(output.error.data());
    }
    return std::move(output.bytes);
}

}  // namespace

void write_png(const std::filesystem::path& file, const Image& image, const PngOptions& options) {
    if (image.width <= 0 || image.height <= 0) {
        throw Error(ErrorCode::usage, file.string(), "a picture without pixels cannot be written");
    }
    std::string bytes;
    try {
        bytes = encode_png(image, options);
    } catch (const std::exception& error) {
        throw Error(ErrorCode::file, file.string(), std::string("cannot be encoded: ") + error.what());
    }
    write_file(file, bytes);
}

}  // namespace viscera::io

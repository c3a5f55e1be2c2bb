#include <algorithm>
#include <cstring>
#include <memory>

#include "engine/core/error.h"
#include "engine/core/size_text.h"
#include "engine/io/exr.h"
#include "engine/io/file_bytes.h"
#include "engine/io/png.h"

// stb_image's code is made here, for the two formats that are read with it.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace viscera::io {

namespace {

struct Free {
    void operator()(void* memory) const { stbi_image_free(memory); }
};

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& message) {
    throw Error(ErrorCode::file, file.string(), message);
}

/// Turns rows from top first to bottom first.
void copy_rows(const unsigned char* top_first, Image& image) {
    const std::size_t row_bytes = image.data.size() / static_cast<std::size_t>(image.height);
    for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
        std::memcpy(image.data.data() + (static_cast<std::size_t>(image.height) - 1 - y) * row_bytes,
                    top_first + y * row_bytes, row_bytes);
    }
}

Image read_png_or_jpeg(const std::filesystem::path& file) {
    constexpr std::size_t most_bytes = std::size_t{1} << 30U;
    constexpr std::int64_t most_pixels = std::int64_t{1} << 28U;
    const std::string bytes = read_file(file, most_bytes);
    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = static_cast<int>(bytes.size());

    int width = 0;
    int height = 0;
    int channels = 0;
    if (stbi_info_from_memory(data, size, &width, &height, &channels) == 0) {
        fail(file, std::string("is no readable picture: ") + stbi_failure_reason());
    }
    if (width <= 0 || height <= 0 || std::int64_t{width} * height > most_pixels) {
        fail(file, "claims " + size_text({width, height}) + " pixels");
    }
    const bool grey = channels == 1;
    const int wanted = grey ? 1 : 4;
    const auto check = [&](const void* pixels) {
        if (pixels == nullptr) {
            fail(file, std::string("is damaged: ") + stbi_failure_reason());
        }
    };
    if (stbi_is_16_bit_from_memory(data, size) != 0) {
        const std::unique_ptr<stbi_us, Free> pixels(
            stbi_load_16_from_memory(data, size, &width, &height, &channels, wanted));
        check(pixels.get());
        Image image = make_image(width, height, grey ? PixelFormat::r32f : PixelFormat::rgba32f);
        std::vector<float> values(image.data.size() / sizeof(float));
        std::transform(pixels.get(), pixels.get() + values.size(), values.begin(),
                       [](stbi_us value) { return static_cast<float>(value) / 65535.0F; });
        copy_rows(reinterpret_cast<const unsigned char*>(values.data()), image);
        return image;
    }
    const std::unique_ptr<stbi_uc, Free> pixels(
        stbi_load_from_memory(data, size, &width, &height, &channels, wanted));
    check(pixels.get());
    Image image = make_image(width, height, grey ? PixelFormat::r8 : PixelFormat::rgba8);
    copy_rows(pixels.get(), image);
    return image;
}

}  // namespace

Image read_image(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    if (extension == ".exr") {
        std::vector<ExrPart> parts = read_exr(file);
        if (parts.empty()) {
            fail(file, "holds no picture");
        }
        return std::move(parts.front().image);
    }
    if (extension == ".png" || extension == ".jpg" || extension == ".jpeg") {
        return read_png_or_jpeg(file);
    }
    fail(file, "is no picture that can be read: .png, .jpg and .exr can");
}

}  // namespace viscera::io

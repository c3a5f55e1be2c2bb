#include "assets/generate/write_png.h"

#include <zlib.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "assets/generate/write_file.h"

namespace viscera::assets {
namespace {

void append_big_endian(std::string& bytes, std::size_t word) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<char>((word >> shift) & 0xffU));
    }
}

void append_png_chunk(std::string& file, const std::string& type, const std::string& data) {
    append_big_endian(file, data.size());
    const std::string body = type + data;
    file += body;
    append_big_endian(file,
                      crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size())));
}

/// Rows from the top, each as differences from the pixel to the left (filter type 1).
std::string filtered(const ColourImage& image, int channels) {
    std::string bytes;
    for (int y = image.height - 1; y >= 0; --y) {
        bytes.push_back(1);
        glm::ivec4 left(0);
        for (int x = 0; x < image.width; ++x) {
            const glm::vec4& pixel =
                image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                             static_cast<std::size_t>(x)];
            const glm::ivec4 value(glm::clamp(glm::round(pixel * 255.0F), 0.0F, 255.0F));
            for (int c = 0; c < channels; ++c) {
                bytes.push_back(static_cast<char>((value[c] - left[c]) & 0xff));
            }
            left = value;
        }
    }
    return bytes;
}

std::string compressed(const std::string& bytes) {
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    std::string result(size, '\0');
    const int status =
        compress2(reinterpret_cast<Bytef*>(result.data()), &size,
                  reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()), 6);
    if (status != Z_OK) {
        throw std::runtime_error("zlib cannot compress a picture");
    }
    result.resize(size);
    return result;
}

}  // namespace

void write_png(const ColourImage& image, bool with_alpha, const std::filesystem::path& path) {
    std::string header;
    append_big_endian(header, static_cast<std::size_t>(image.width));
    append_big_endian(header, static_cast<std::size_t>(image.height));
    header += std::string({8, static_cast<char>(with_alpha ? 6 : 2), 0, 0, 0});
    std::string file = "\x89PNG\r\n\x1a\n";
    append_png_chunk(file, "IHDR", header);
    append_png_chunk(file, "IDAT", compressed(filtered(image, with_alpha ? 4 : 3)));
    append_png_chunk(file, "IEND", "");
    write_file(path, file);
}

}  // namespace viscera::assets

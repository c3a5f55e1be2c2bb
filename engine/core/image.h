#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/core/pixel_format.h"

namespace viscera {

/// A picture in memory. Row 0 is the BOTTOM row (OpenGL's order); rows are tightly packed, channels
/// interleaved.
struct Image {
    int width = 0;   ///< [pixels], >= 0
    int height = 0;  ///< [pixels], >= 0
    PixelFormat format = PixelFormat::rgba8;
    std::vector<std::byte> data;  ///< width * height * bytes_per_pixel(format) bytes

    [[nodiscard]] int channels() const { return info(format).channels; }
    [[nodiscard]] bool empty() const { return width == 0 || height == 0; }
    /// Channel c of pixel (x, y) as float: unorm8 as n/255, half widened exactly. No range check beyond
    /// assert.
    [[nodiscard]] float at(int x, int y, int c) const;
    /// Stores with rounding to nearest (half, unorm8; unorm8 clamps and stores NaN as 0).
    void set(int x, int y, int c, float value);
};

/// Zero-filled picture. Throws Error(limit) when the byte count overflows.
[[nodiscard]] Image make_image(int width, int height, PixelFormat format);

/// All channels as float, interleaved, rows bottom first: width * height * channels values.
[[nodiscard]] std::vector<float> to_floats(const Image& image);

/// IEEE 754 binary16 to binary32, exact, and back with round to nearest even.
[[nodiscard]] float half_to_float(unsigned short bits);
[[nodiscard]] unsigned short float_to_half(float value);

/// Names of the channels as EXR files carry them: "Y" for one channel, "R","G" for two, "R","G","B","A"
/// for four, "Z" for depth.
[[nodiscard]] std::vector<std::string> default_channel_names(PixelFormat format);

}  // namespace viscera

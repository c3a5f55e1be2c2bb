#pragma once

#include <filesystem>

#include "engine/core/image.h"

namespace viscera::io {

struct PngOptions {
    bool srgb = false;         ///< encode colour (not alpha) from linear to sRGB
    bool sixteen_bit = false;  ///< 16 bits per channel in place of 8
    bool alpha = true;         ///< keep the fourth channel; false: three channels, alpha ignored
};

/// Writes a picture for a look: one channel as grey, two as red and green, four as RGBA or RGB. Values are
/// clamped to [0, 1], NaN becomes 0. The file appears whole or not at all. Throws Error(file) when it cannot
/// be written, Error(usage) for an empty picture.
void write_png(const std::filesystem::path& file, const Image& image, const PngOptions& options = {});

/// Reads .png, .jpg, .jpeg or .exr (its first picture) as stored, without any change of colour space. PNG and
/// JPEG give r8 for grey, rgba8 for the rest, or r32f and rgba32f (n/65535) where the file has 16 bits.
/// Throws Error(file) for a missing, damaged or oversized file or another extension.
[[nodiscard]] Image read_image(const std::filesystem::path& file);

}  // namespace viscera::io

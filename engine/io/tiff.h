#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace viscera::io {

/// The first page of a TIFF file. Top row first, rows tightly packed, channels interleaved.
struct TiffPicture {
    int width = 0;
    int height = 0;
    int bits = 8;      ///< 8 or 16, unsigned, native byte order
    int channels = 1;  ///< 1 to 4
    std::vector<std::byte> bytes;
};

/// Rows or tiles, channels beside each other or apart; a palette of 256 colours becomes these. Throws
/// Error(file) for a missing or damaged file and for other sample formats.
[[nodiscard]] TiffPicture read_tiff(const std::filesystem::path& file);

}  // namespace viscera::io

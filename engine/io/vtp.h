#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace viscera::io {

/// One data array of a VTK XML file, every numeric type widened to double (integers beyond 2^53 are not
/// exact).
struct VtkArray {
    std::string name;
    std::size_t components = 1;
    std::vector<double> values;  ///< tuples one after another
};

/// Cells of one kind: cell i has connectivity[offsets[i - 1]] to connectivity[offsets[i] - 1].
struct VtkCells {
    std::vector<std::uint32_t> connectivity;  ///< point indices, not yet checked against the number of points
    std::vector<std::size_t> offsets;         ///< never falling, within connectivity
};

/// One piece of a PolyData file. Every point array has one tuple per point.
struct VtpPiece {
    std::size_t points = 0;
    std::vector<double> positions;  ///< x, y, z per point
    std::vector<VtkArray> point_data;
    std::string normals_name;  ///< of the array that the file marks as normals
    std::string uvs_name;      ///< of the array that the file marks as texture coordinates
    VtkCells lines;
    VtkCells polys;
    VtkCells strips;
};

/// Reads a VTK XML PolyData file (.vtp): arrays as text, base64 or appended (raw or base64), plain or packed
/// with zlib, 32- or 64-bit headers, either byte order. Throws Error(file) for a damaged file, another VTK
/// type or another packing.
[[nodiscard]] std::vector<VtpPiece> read_vtp(const std::filesystem::path& file);

}  // namespace viscera::io

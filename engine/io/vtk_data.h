#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace viscera::io {

/// How a VTK XML file stores its binary arrays.
struct VtkEncoding {
    bool big_endian = false;
    bool header_64bit = false;
    bool zlib = false;
};

/// Numbers of a text array. Throws std::runtime_error where the text is none.
[[nodiscard]] std::vector<double> parse_vtk_text(std::string_view text);

/// Bytes of base64 text; white space and padding in the middle are skipped, since header and data are often
/// encoded one after the other. Throws std::runtime_error for other characters.
[[nodiscard]] std::string decode_base64(std::string_view text);

/// Bytes of a binary array that begins with its VTK header, unpacked and as they are stored; bytes beyond its
/// end are left alone. Throws std::runtime_error when the bytes do not hold what the header claims.
[[nodiscard]] std::string decode_vtk_bytes(std::string_view bytes, const VtkEncoding& encoding);

/// Values of a binary array that begins with its VTK header; bytes beyond its end are left alone. `type`:
/// "Float32", "Int64", ... Throws std::runtime_error when the bytes do not hold what the header claims.
[[nodiscard]] std::vector<double> decode_vtk_array(std::string_view bytes, std::string_view type,
                                                   const VtkEncoding& encoding);

}  // namespace viscera::io

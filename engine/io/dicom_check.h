#pragma once

#include <cstdint>
#include <string_view>

namespace viscera::io {

/// Walks through the elements of a DICOM file, sequences included, and throws std::runtime_error where one
/// leaves the file or is none. GDCM ends the program at such places, so no file may reach it unchecked. Both
/// byte orders; what is deflated is unpacked, and std::length_error thrown where that takes more than
/// `most_bytes`.
void check_dicom(std::string_view bytes, std::uint64_t most_bytes);

}  // namespace viscera::io

#pragma once

#include <string_view>

namespace viscera::io {

/// Walks through the elements of a DICOM file, sequences included, and throws std::runtime_error where one
/// leaves the file or is none. GDCM ends the program at such places, so no file may reach it unchecked.
void check_dicom(std::string_view bytes);

}  // namespace viscera::io

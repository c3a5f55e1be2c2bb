#pragma once

#include <string_view>

#include "engine/io/volume_head.h"

namespace viscera::io {

// One reader for each format; each throws as load_volume does.
[[nodiscard]] Volume read_meta_image(const Reading& reading);
[[nodiscard]] Volume read_nrrd(const Reading& reading);
[[nodiscard]] Volume read_nifti(const Reading& reading);
[[nodiscard]] Volume read_legacy_vtk(const Reading& reading);
[[nodiscard]] Volume read_vti(const Reading& reading);
[[nodiscard]] Volume read_csv_volume(const Reading& reading);
[[nodiscard]] Volume read_raw_sidecar(const Reading& reading);
[[nodiscard]] Volume read_invesalius(const Reading& reading);
/// A DICOM file or a folder of them.
[[nodiscard]] Volume read_dicom(const Reading& reading);
/// A folder of PNG, JPEG or TIFF slices.
[[nodiscard]] Volume read_slices(const Reading& reading);

/// Whether a file begins as DICOM files do.
[[nodiscard]] bool is_dicom(const std::filesystem::path& file);
/// Whether a folder holds pictures of the kinds that read_slices takes.
[[nodiscard]] bool has_slices(const std::filesystem::path& folder);

/// The first bytes of a file, at most `size`; empty when it cannot be read.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& file, std::size_t size);

}  // namespace viscera::io

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "engine/core/log.h"
#include "engine/core/volume.h"

namespace viscera::io {

struct VolumeOptions {
    Progress progress{};  ///< called from the calling thread
    /// > 1: each `reduce` voxels of an axis become one (mean; labels: the first).
    int reduce = 1;
    bool labels = false;
    /// What becomes of the grid that the file gives before its voxels are read: for a geometry that the file
    /// does not hold. Empty: it stays.
    std::function<VolumeGrid(const VolumeGrid&)> regrid{};
    /// Bytes that the voxels may take in memory; 0: what the machine has available now.
    std::uint64_t memory_limit = 0;
    /// DICOM folders with several series: SeriesInstanceUID; empty: the one with most slices, the log says
    /// which.
    std::string series{};
};

/// Reads a volume. By extension or content:
/// a folder of DICOM files or of PNG/JPEG/TIFF slices in natural order; .dcm (and extensionless DICOM; its
/// series in the same folder); .nii, .nii.gz, .hdr/.img; .nrrd, .nhdr; .mha, .mhd; .vtk (legacy structured
/// points, ASCII and binary big-endian); .vti; .csv (x,y,z,value); .json (sidecar of a raw file: {"file",
/// "dims", "type", "byte_order", "spacing_mm", "origin_mm", "direction", "slope", "intercept", "unit",
/// "channels", "offset", "axes"}, raw may be gzipped). Orientation ends in LPS mm whatever the file's
/// convention; f64, 32- and 64-bit integers are narrowed to f32, with the largest error in narrowing_error
/// and in the log. Throws Error(file) naming file and field for one that is damaged, truncated, lies about
/// its size, or has a zero or non-finite spacing; Error(limit) saying what it needs, what there is, and which
/// `reduce` would do; nothing is half-loaded. NaN and Inf voxels stay, counted with
/// Log::fault("volume.non_finite").
[[nodiscard]] Volume load_volume(const std::filesystem::path& file, const VolumeOptions& options, Log& log);

/// Whether load_volume would take the file for a volume, judged by name and first bytes.
[[nodiscard]] bool is_volume(const std::filesystem::path& file);

/// Writes .nrrd, .mha or .nii.gz (compressed) by extension, orientation and rescale included; curvilinear
/// volumes only as .nrrd. Throws Error(file).
void write_volume(const Volume& volume, const std::filesystem::path& file);

}  // namespace viscera::io

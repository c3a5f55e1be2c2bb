#pragma once

#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/io/volume_head.h"

namespace viscera::io {

/// Keeps the warnings of ITK and GDCM off the host's standard error stream while it lives.
class QuietItk {
  public:
    QuietItk();
    QuietItk(const QuietItk&) = delete;
    QuietItk& operator=(const QuietItk&) = delete;
    ~QuietItk();

  private:
    bool itk_warns_;
    bool gdcm_warns_;
    bool gdcm_tells_errors_;
};

/// What an exception says of the file; ITK's also name places in ITK's source, which are left out.
[[nodiscard]] std::string words_of(const std::exception& error);

enum class ItkFormat { meta, nifti, nrrd };

/// What ITK reads from a header.
struct ItkHeader {
    VolumeGrid grid;  ///< the first three axes, in LPS mm
    std::vector<std::uint64_t> dims;
    int components = 1;
};

/// Orientation and size as ITK understands them, so that a volume lies where other programs put it. Throws
/// std::runtime_error with ITK's words.
[[nodiscard]] ItkHeader read_itk_header(ItkFormat format, const std::filesystem::path& file);

/// The voxels as ITK reads them, for files whose voxels are not one run of plain or zlib bytes: text, hex,
/// bzip2, lists of files. Size and memory are to be checked before. Throws Error(file).
[[nodiscard]] std::vector<std::byte> read_itk_voxels(ItkFormat format, const VolumeHead& head,
                                                     const Reading& reading);

/// Grid of an affine map from index to LPS mm: unit columns and their lengths. Axes may be sheared.
[[nodiscard]] VolumeGrid grid_of_affine(const glm::dmat4& index_to_world, const glm::ivec3& dims);

}  // namespace viscera::io

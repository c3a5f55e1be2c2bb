#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_text.h"

namespace viscera::io {

namespace {

using Read = Volume (*)(const Reading&);

/// Whether a header of 348 or 540 bytes, in either byte order, begins the file: .hdr are pictures, too.
bool begins_as_nifti(const std::filesystem::path& file) {
    using namespace std::string_view_literals;
    const std::string start = first_bytes(file, 4);
    const std::array sizes{"\x5c\x01\0\0"sv, "\0\0\x01\x5c"sv, "\x1c\x02\0\0"sv, "\0\0\x02\x1c"sv};
    return std::ranges::find(sizes, start) != sizes.end();
}

bool has_word(const std::filesystem::path& file, std::initializer_list<std::string_view> words) {
    const std::string start = lower(first_bytes(file, std::size_t{1} << 16U));
    return std::ranges::all_of(words, [&](std::string_view word) { return start.find(word) != start.npos; });
}

/// The reader that a name asks for; null where it asks for none.
Read reader_by_name(const std::filesystem::path& file) {
    struct Ending {
        std::string_view text;
        Read read;
    };
    static constexpr std::array<Ending, 15> endings{{{".mha", read_meta_image},
                                                     {".mhd", read_meta_image},
                                                     {".nrrd", read_nrrd},
                                                     {".nhdr", read_nrrd},
                                                     {".nii", read_nifti},
                                                     {".nii.gz", read_nifti},
                                                     {".hdr", read_nifti},
                                                     {".img", read_nifti},
                                                     {".img.gz", read_nifti},
                                                     {".vtk", read_legacy_vtk},
                                                     {".vti", read_vti},
                                                     {".csv", read_csv_volume},
                                                     {".json", read_raw_sidecar},
                                                     {".plist", read_invesalius},
                                                     {".dcm", read_dicom}}};
    const std::string name = lower(file.filename().string());
    const auto* const found =
        std::ranges::find_if(endings, [&](const Ending& ending) { return name.ends_with(ending.text); });
    return found == endings.end() ? nullptr : found->read;
}

Read reader_of(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) {
        return has_slices(file) ? read_slices : read_dicom;
    }
    if (const Read by_name = reader_by_name(file)) {
        return by_name;
    }
    if (is_dicom(file)) {
        return read_dicom;
    }
    if (first_bytes(file, 4) == "NRRD") {
        return read_nrrd;
    }
    return begins_as_nifti(file) ? read_nifti : nullptr;
}

void count_non_finite(const Volume& volume, Log& log) {
    if (volume.type != ScalarType::f32) {
        return;
    }
    std::uint64_t count = 0;
    for (std::size_t at = 0; at < volume.voxels.size(); at += sizeof(float)) {
        float value = 0.0F;
        std::memcpy(&value, volume.voxels.data() + at, sizeof value);
        count += is_number(value) ? 0 : 1;
    }
    report_no_numbers(volume, count, log);
}

}  // namespace

Volume load_volume(const std::filesystem::path& file, const VolumeOptions& options, Log& log) {
    const Reading reading{file, options, log};
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
        reading.fail("does not exist");
    }
    const Read read = reader_of(file);
    if (read == nullptr) {
        reading.fail(
            "is no volume that can be read: DICOM, NIfTI, Analyze, NRRD, MetaImage, VTK structured points, "
            "VTI, "
            "folders of PNG, JPEG or TIFF slices, CSV, InVesalius, and raw files with a .json beside them "
            "can");
    }
    try {
        Volume volume = read(reading);
        volume.source = file.string();
        volume.validate();
        if (volume.narrowing_error > 0.0) {
            log.info(volume.source + ": voxels are narrowed to 32-bit floats, with a largest error of " +
                     std::to_string(volume.narrowing_error));
        }
        count_non_finite(volume, log);
        return volume;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::limit, file.string(), "needs more memory than there is");
    } catch (const std::exception& error) {
        reading.fail(error.what());
    }
}

bool is_volume(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) {
        if (has_slices(file)) {
            return true;
        }
        return std::ranges::any_of(std::filesystem::directory_iterator(file, ignored), [](const auto& entry) {
            return is_dicom(entry.path()) || lower_extension(entry.path()) == ".dcm";
        });
    }
    if (!std::filesystem::is_regular_file(file, ignored)) {
        return false;
    }
    const std::string extension = lower_extension(file);
    if (extension == ".hdr") {
        return begins_as_nifti(file);
    }
    if (extension == ".vtk") {
        return has_word(file, {"structured_points"});
    }
    if (extension == ".json") {
        return has_word(file, {"\"file\"", "\"dims\"", "\"type\""});
    }
    if (extension == ".plist") {
        return has_word(file, {"invesalius"});
    }
    return reader_of(file) != nullptr;
}

}  // namespace viscera::io

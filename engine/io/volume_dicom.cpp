#include <itkGDCMImageIO.h>
#include <itkMetaDataObject.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>

#include "engine/core/error.h"
#include "engine/io/dicom_check.h"
#include "engine/io/file_bytes.h"
#include "engine/io/volume_itk.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_text.h"
#include "engine/io/words.h"

namespace viscera::io {

namespace {

using ImageIo = itk::GDCMImageIO;

/// One file: usually a slice.
struct Slice {
    std::filesystem::path file;
    std::string series;
    std::string modality;
    glm::ivec3 dims{1};
    FileScalar type = FileScalar::u16;
    int channels = 1;
    double slope = 1.0;
    double intercept = 0.0;
    bool has_position = false;
    glm::dvec3 position{};
    glm::dmat3 direction{1.0};
    glm::dvec3 spacing{1.0};
    double instance = 0.0;
};

std::optional<FileScalar> scalar_of(itk::IOComponentEnum type) {
    switch (type) {
        case itk::IOComponentEnum::UCHAR:
            return FileScalar::u8;
        case itk::IOComponentEnum::CHAR:
            return FileScalar::i8;
        case itk::IOComponentEnum::USHORT:
            return FileScalar::u16;
        case itk::IOComponentEnum::SHORT:
            return FileScalar::i16;
        case itk::IOComponentEnum::UINT:
            return FileScalar::u32;
        case itk::IOComponentEnum::INT:
            return FileScalar::i32;
        case itk::IOComponentEnum::FLOAT:
            return FileScalar::f32;
        case itk::IOComponentEnum::DOUBLE:
            return FileScalar::f64;
        default:
            return std::nullopt;
    }
}

std::string tag(const ImageIo& io, const char* name) {
    std::string value;
    itk::ExposeMetaData<std::string>(io.GetMetaDataDictionary(), name, value);
    return std::string(trim(std::string_view(value).substr(0, value.find('\0'))));
}

ImageIo::Pointer open(const std::filesystem::path& file) {
    const ImageIo::Pointer io = ImageIo::New();
    io->SetFileName(file.string());
    io->ReadImageInformation();
    return io;
}

/// GDCM puts the axes of the world in place of axes that are none.
void check_orientation(std::string text) {
    if (text.empty()) {
        return;
    }
    std::ranges::replace(text, '\\', ' ');
    std::array<double, 6> v{};
    std::string_view rest = text;
    for (double& number : v) {
        number = to_number(take_word(rest)).value_or(0.0);
    }
    const glm::dvec3 row(v[0], v[1], v[2]);
    const glm::dvec3 column(v[3], v[4], v[5]);
    constexpr double rounding = 1e-2;
    if (!(std::abs(glm::length(row) - 1.0) < rounding && std::abs(glm::length(column) - 1.0) < rounding &&
          std::abs(glm::dot(row, column)) < rounding)) {
        throw std::runtime_error("ImageOrientationPatient holds no two axes at right angles");
    }
}

void check(const std::filesystem::path& file, const Reading& reading) {
    try {
        check_dicom(read_file(file), memory_of(reading));
    } catch (const std::length_error& error) {
        throw Error(ErrorCode::limit, reading.file.string(),
                    "'" + file.filename().string() + "' " + error.what());
    }
}

Slice describe_slice(const std::filesystem::path& file, const Reading& reading) {
    check(file, reading);
    const ImageIo::Pointer io = open(file);
    Slice slice{.file = file, .series = tag(*io, "0020|000e"), .modality = tag(*io, "0008|0060")};
    const std::optional<FileScalar> type = scalar_of(io->GetInternalComponentType());
    if (!type) {
        throw std::runtime_error("its pixels have a type that is not read");
    }
    slice.type = *type;
    slice.channels = static_cast<int>(io->GetNumberOfComponents());
    for (unsigned int axis = 0; axis < std::min(io->GetNumberOfDimensions(), 3U); ++axis) {
        const auto a = static_cast<int>(axis);
        const std::uint64_t size = io->GetDimensions(axis);
        slice.dims[a] = static_cast<int>(std::min<std::uint64_t>(size, 500'000'000));
        slice.spacing[a] = io->GetSpacing(axis);
        slice.position[a] = io->GetOrigin(axis);
        const std::vector<double> column = io->GetDirection(axis);
        for (std::size_t row = 0; row < std::min<std::size_t>(column.size(), 3); ++row) {
            slice.direction[a][static_cast<int>(row)] = column[row];
        }
    }
    check_orientation(tag(*io, "0020|0037"));
    slice.slope = io->GetRescaleSlope();
    slice.intercept = io->GetRescaleIntercept();
    slice.has_position = slice.dims.z > 1 || !tag(*io, "0020|0032").empty();
    slice.instance = to_number(tag(*io, "0020|0013")).value_or(0.0);
    return slice;
}

template <class T>
std::vector<double> widen(const std::vector<char>& bytes) {
    std::vector<double> numbers(bytes.size() / sizeof(T));
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        T value{};
        std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof value);
        numbers[i] = static_cast<double>(value);
    }
    return numbers;
}

std::vector<double> widen(const std::vector<char>& bytes, FileScalar type) {
    switch (type) {
        case FileScalar::u8:
            return widen<std::uint8_t>(bytes);
        case FileScalar::i8:
            return widen<std::int8_t>(bytes);
        case FileScalar::u16:
            return widen<std::uint16_t>(bytes);
        case FileScalar::i16:
            return widen<std::int16_t>(bytes);
        case FileScalar::u32:
            return widen<std::uint32_t>(bytes);
        case FileScalar::i32:
            return widen<std::int32_t>(bytes);
        case FileScalar::f32:
            return widen<float>(bytes);
        default:
            return widen<double>(bytes);
    }
}

/// Pixels as stored where the whole series shares its rescale, else rescaled. ITK applies the rescale on
/// reading; for integers taking it back is exact.
std::vector<std::byte> read_pixels(const Slice& slice, bool keep_stored, const Reading& reading) {
    constexpr std::uint64_t best_compression = 1100;
    const ImageIo::Pointer io = open(slice.file);
    const auto size = static_cast<std::uint64_t>(io->GetImageSizeInBytes());
    if (size / best_compression > size_of(slice.file, reading)) {
        reading.fail("'" + slice.file.filename().string() + "' lies about its size");
    }
    const std::optional<FileScalar> type = scalar_of(io->GetComponentType());
    if (!type) {
        reading.fail("'" + slice.file.filename().string() + "': its pixels have a type that is not read");
    }
    std::vector<char> bytes(size);
    io->Read(bytes.data());
    std::vector<double> numbers = widen(bytes, *type);
    if (keep_stored && slice.type != FileScalar::f32 && slice.type != FileScalar::f64) {
        for (double& number : numbers) {
            number = std::round((number - slice.intercept) / slice.slope);
        }
    } else if (keep_stored) {
        for (double& number : numbers) {
            number = (number - slice.intercept) / slice.slope;
        }
    }
    return encode(numbers, keep_stored ? slice.type : FileScalar::f32, reading);
}

/// Slices of one volume share all that this compares.
auto group_key(const Slice& slice) {
    std::array<long, 6> orientation{};
    for (int i = 0; i < 6; ++i) {
        orientation.at(static_cast<std::size_t>(i)) = std::lround(slice.direction[i / 3][i % 3] * 1e3);
    }
    return std::tuple(slice.series, slice.dims.x, slice.dims.y, slice.channels, slice.type, orientation);
}

std::vector<std::filesystem::path> files_of(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        if (entry.is_regular_file(ignored) &&
            (is_dicom(entry.path()) || lower_extension(entry.path()) == ".dcm")) {
            files.push_back(entry.path());
        }
    }
    std::ranges::sort(files);
    return files;
}

/// The slices of the series asked for, or of the largest.
std::vector<Slice> choose(std::vector<Slice> slices, const std::string& series, const Reading& reading) {
    std::map<decltype(group_key(slices[0])), std::vector<Slice>> groups;
    for (Slice& slice : slices) {
        auto key = group_key(slice);
        groups[std::move(key)].push_back(std::move(slice));
    }
    const std::vector<Slice>* best = nullptr;
    std::string others;
    for (const auto& [key, group] : groups) {
        const std::string& uid = std::get<0>(key);
        others += (others.empty() ? "" : ", ") + printable(uid) + " (" + std::to_string(group.size()) + ")";
        if ((series.empty() || uid == series) && (best == nullptr || group.size() > best->size())) {
            best = &group;
        }
    }
    if (best == nullptr) {
        reading.fail("holds no series '" + printable(series) + "'; it holds " + others);
    }
    if (groups.size() > 1) {
        reading.log.info(reading.file.string() + ": series " + printable(best->front().series) + " with " +
                         std::to_string(best->size()) + " slices is read; there are (files): " + others);
    }
    return *best;
}

/// Sorts by place along the normal, and drops all but the first of those at one place.
void sort_slices(std::vector<Slice>& slices, const glm::dvec3& normal, const Reading& reading) {
    const bool placed = std::ranges::all_of(slices, &Slice::has_position);
    std::ranges::stable_sort(slices, {}, &Slice::instance);
    if (!placed) {
        reading.log.warning(reading.file.string() +
                            ": ImagePositionPatient is missing; slices are sorted by InstanceNumber");
        return;
    }
    const auto place = [&](const Slice& slice) { return glm::dot(slice.position, normal); };
    std::ranges::stable_sort(slices, {}, place);
    constexpr double same_mm = 1e-3;
    const auto same = [&](const Slice& a, const Slice& b) { return place(b) - place(a) < same_mm; };
    const auto rest = std::ranges::unique(slices, same);
    if (!rest.empty()) {
        reading.log.fault("volume.duplicate_slices",
                          reading.file.string() + ": several slices at one place; the first of each is read",
                          rest.size());
        slices.erase(rest.begin(), rest.end());
    }
}

/// Where the stack lies. Slices may be shifted against each other (a tilted gantry): the third axis then runs
/// from slice to slice, not along the normal.
VolumeGrid stack_grid(const std::vector<Slice>& slices, const Reading& reading) {
    const Slice& first = slices.front();
    VolumeGrid grid{.dims = first.dims,
                    .spacing_mm = first.spacing,
                    .origin_mm = first.position,
                    .direction = first.direction};
    if (slices.size() < 2) {
        return grid;
    }
    grid.dims.z = static_cast<int>(slices.size());
    const glm::dvec3 normal = glm::cross(first.direction[0], first.direction[1]);
    grid.direction[2] = normal;
    if (!std::ranges::all_of(slices, &Slice::has_position)) {
        return grid;
    }
    const glm::dvec3 step =
        (slices.back().position - first.position) / static_cast<double>(slices.size() - 1);
    grid.spacing_mm.z = glm::length(step);
    grid.direction[2] = step / grid.spacing_mm.z;
    double worst = 0.0;
    for (std::size_t i = 0; i < slices.size(); ++i) {
        const glm::dvec3 due = first.position + static_cast<double>(i) * step;
        worst = std::max(worst, glm::length(slices[i].position - due));
    }
    if (worst > 0.01 * grid.spacing_mm.z) {
        reading.log.warning(reading.file.string() + ": its slices are not evenly spaced; one lies " +
                            std::to_string(worst) + " mm from where it is shown");
    }
    return grid;
}

std::vector<Slice> find_slices(const Reading& reading) {
    const bool is_folder = std::filesystem::is_directory(reading.file);
    std::string series = reading.options.series;
    if (!is_folder) {
        static_cast<void>(size_of(reading.file, reading));
        Slice one = describe_slice(reading.file, reading);
        if (one.dims.z > 1 || one.series.empty()) {
            return {std::move(one)};
        }
        series = series.empty() ? one.series : series;
    }
    const auto folder = is_folder ? reading.file : std::filesystem::absolute(reading.file).parent_path();
    std::vector<Slice> slices;
    std::string reason = "holds no DICOM images";
    for (const std::filesystem::path& file : files_of(folder)) {
        try {
            slices.push_back(describe_slice(file, reading));
        } catch (const std::exception& error) {
            const std::string text =
                "'" + file.filename().string() + "' is no DICOM image that can be read: " + words_of(error);
            // Folders often hold a directory, a report or a presentation state beside the images.
            reading.log.fault("volume.dicom_file", reading.file.string() + ": " + text);
            reason = text;
        }
    }
    if (slices.empty()) {
        reading.fail(reason);
    }
    return choose(std::move(slices), series, reading);
}

Volume read_stack(const Reading& reading) {
    std::vector<Slice> slices = find_slices(reading);
    const Slice model = slices.front();
    if (model.dims.z > 1 && slices.size() > 1) {
        reading.fail("holds several files with many frames each: name one of them");
    }
    if (slices.size() > 1) {
        sort_slices(slices, glm::cross(model.direction[0], model.direction[1]), reading);
    }
    const bool one_rescale = std::ranges::all_of(slices, [&](const Slice& slice) {
        return slice.slope == model.slope && slice.intercept == model.intercept;
    });
    VolumeHead head;
    head.volume.grid = stack_grid(slices, reading);
    head.volume.channels = model.channels;
    head.type = one_rescale ? model.type : FileScalar::f32;
    head.volume.slope = one_rescale ? model.slope : 1.0;
    head.volume.intercept = one_rescale ? model.intercept : 0.0;
    head.volume.unit = model.modality == "CT" ? "HU" : "";
    const std::uint64_t slice_bytes = head.bytes(reading) / slices.size();
    require_memory(head, slice_bytes, reading);
    const ReadBytes read = read_slice_by_slice([&](std::size_t index) {
        std::vector<std::byte> bytes = read_pixels(slices.at(index), one_rescale, reading);
        if (bytes.size() != slice_bytes) {
            reading.fail("'" + slices[index].file.filename().string() + "' has another size than the others");
        }
        return bytes;
    });
    return read_voxels(head, read, reading);
}

}  // namespace

bool is_dicom(const std::filesystem::path& file) {
    constexpr std::size_t preamble = 128;
    const std::string bytes = first_bytes(file, preamble + 4);
    return bytes.size() == preamble + 4 && bytes.ends_with("DICM");
}

Volume read_dicom(const Reading& reading) {
    const QuietItk quiet;
    try {
        return read_stack(reading);
    } catch (const itk::ExceptionObject& error) {
        reading.fail(words_of(error));
    }
}

}  // namespace viscera::io

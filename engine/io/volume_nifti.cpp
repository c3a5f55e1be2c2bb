#include <nifti/nifti1.h>
#include <nifti/nifti2.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/volume_itk.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_text.h"

namespace viscera::io {

namespace {

/// What NIfTI-1, NIfTI-2 and Analyze 7.5 headers say, in one form.
struct NiftiHeader {
    int version = 1;  ///< 0: Analyze 7.5
    bool big_endian = false;
    bool single_file = true;  ///< voxels in the same file
    std::array<std::int64_t, 8> dim{};
    std::array<double, 8> pixdim{};
    int datatype = 0;
    double voxel_offset = 0.0;
    double slope = 0.0;
    double intercept = 0.0;
    int units = 0;
    int qform = 0;
    int sform = 0;
    glm::dvec3 quaternion{};  ///< b, c, d
    glm::dvec3 offset{};
    glm::dmat4 srow{1.0};  ///< rows of the affine map, as columns
};

template <class T>
T swapped(T value, bool swap) {
    if (!swap) {
        return value;
    }
    auto bytes = std::bit_cast<std::array<std::byte, sizeof(T)>>(value);
    std::ranges::reverse(bytes);
    return std::bit_cast<T>(bytes);
}

/// Both headers name their fields alike.
template <class Raw>
NiftiHeader common_fields(const Raw& raw, bool swap) {
    const auto get = [swap](auto value) { return swapped(value, swap); };
    NiftiHeader header;
    header.big_endian = swap;
    for (std::size_t i = 0; i < 8; ++i) {
        header.dim.at(i) = get(raw.dim[i]);
        header.pixdim.at(i) = static_cast<double>(get(raw.pixdim[i]));
    }
    header.datatype = get(raw.datatype);
    header.voxel_offset = static_cast<double>(get(raw.vox_offset));
    header.slope = static_cast<double>(get(raw.scl_slope));
    header.intercept = static_cast<double>(get(raw.scl_inter));
    header.units = static_cast<unsigned char>(get(raw.xyzt_units));
    header.qform = get(raw.qform_code);
    header.sform = get(raw.sform_code);
    header.quaternion = {get(raw.quatern_b), get(raw.quatern_c), get(raw.quatern_d)};
    header.offset = {get(raw.qoffset_x), get(raw.qoffset_y), get(raw.qoffset_z)};
    for (int i = 0; i < 4; ++i) {
        header.srow[0][i] = static_cast<double>(get(raw.srow_x[i]));
        header.srow[1][i] = static_cast<double>(get(raw.srow_y[i]));
        header.srow[2][i] = static_cast<double>(get(raw.srow_z[i]));
    }
    header.single_file = raw.magic[1] == '+';
    return header;
}

constexpr std::int32_t first_size = sizeof(nifti_1_header);
constexpr std::int32_t second_size = sizeof(nifti_2_header);

/// The field sizeof_hdr, and whether it and all others are stored in the other byte order.
std::pair<std::int32_t, bool> size_field(std::string_view bytes) {
    std::int32_t size = 0;
    std::memcpy(&size, bytes.data(), sizeof size);
    const bool swap = size != first_size && size != second_size;
    return {swapped(size, swap), swap};
}

std::string header_bytes(const Payload& place, const Reading& reading) {
    std::string bytes(second_size, '\0');
    const std::span<std::byte> all = std::as_writable_bytes(std::span(bytes));
    const ReadBytes read = open_payload(place, first_size, reading);
    read(all.first(first_size));
    if (size_field(bytes).first == second_size) {
        read(all.subspan(first_size));
    }
    return bytes;
}

NiftiHeader parse(std::string_view bytes, const Reading& reading) {
    const auto [size, swap] = size_field(bytes);
    if (size == second_size) {
        nifti_2_header raw{};
        std::memcpy(&raw, bytes.data(), sizeof raw);
        NiftiHeader header = common_fields(raw, swap);
        header.version = 2;
        return header;
    }
    if (size != first_size) {
        reading.fail("has no NIfTI or Analyze header: sizeof_hdr is neither 348 nor 540");
    }
    nifti_1_header raw{};
    std::memcpy(&raw, bytes.data(), sizeof raw);
    NiftiHeader header = common_fields(raw, swap);
    if (raw.magic[0] != 'n' || (raw.magic[1] != '+' && raw.magic[1] != 'i')) {
        header.version = 0;
        header.single_file = false;
        header.slope = 0.0;
        header.quaternion = {};
        header.offset = {};
        header.srow = glm::dmat4(1.0);
        header.qform = 0;
        header.sform = 0;
        header.voxel_offset = 0.0;
    }
    return header;
}

/// Type on disk and channels that lie beside each other.
struct VoxelType {
    int code;
    FileScalar type;
    int channels;
};

VoxelType voxel_type(int code, const Reading& reading) {
    static constexpr std::array<VoxelType, 12> types{{{DT_UINT8, FileScalar::u8, 1},
                                                      {DT_INT8, FileScalar::i8, 1},
                                                      {DT_UINT16, FileScalar::u16, 1},
                                                      {DT_INT16, FileScalar::i16, 1},
                                                      {DT_UINT32, FileScalar::u32, 1},
                                                      {DT_INT32, FileScalar::i32, 1},
                                                      {DT_UINT64, FileScalar::u64, 1},
                                                      {DT_INT64, FileScalar::i64, 1},
                                                      {DT_FLOAT32, FileScalar::f32, 1},
                                                      {DT_FLOAT64, FileScalar::f64, 1},
                                                      {DT_RGB24, FileScalar::u8, 3},
                                                      {DT_RGBA32, FileScalar::u8, 4}}};
    const auto* const found = std::ranges::find(types, code, &VoxelType::code);
    if (found == types.end()) {
        reading.fail("datatype " + std::to_string(code) + " is not read");
    }
    return *found;
}

double millimetres(int units) {
    constexpr int spatial = 7;
    switch (units & spatial) {
        case NIFTI_UNITS_METER:
            return 1000.0;
        case NIFTI_UNITS_MICRON:
            return 0.001;
        default:
            return 1.0;
    }
}

/// The file's own map, where ITK takes none: axes that are not orthonormal, and NIfTI-2.
VolumeGrid own_grid(const NiftiHeader& header, const glm::ivec3& dims) {
    const double mm = millimetres(header.units);
    const glm::dvec3 spacing{header.pixdim[1], header.pixdim[2], header.pixdim[3]};
    glm::dmat4 ras(1.0);
    if (header.sform > 0) {
        ras = glm::transpose(header.srow);
        ras[3][3] = 1.0;
    } else {
        const glm::dvec3 q = header.qform > 0 ? header.quaternion : glm::dvec3(0.0);
        const double w = std::sqrt(std::max(0.0, 1.0 - glm::dot(q, q)));
        glm::dmat3 rotation = glm::mat3_cast(glm::normalize(glm::dquat(w, q.x, q.y, q.z)));
        // pixdim[0] of -1 mirrors the third axis.
        rotation[2] *= header.qform > 0 && header.pixdim[0] < 0.0 ? -1.0 : 1.0;
        for (int axis = 0; axis < 3; ++axis) {
            ras[axis] = glm::dvec4(rotation[axis] * spacing[axis], 0.0);
        }
        ras[3] = glm::dvec4(header.qform > 0 ? header.offset : glm::dvec3(0.0), 1.0);
    }
    glm::dmat4 lps = ras;
    for (int column = 0; column < 4; ++column) {
        lps[column] *= glm::dvec4(-mm, -mm, mm, 1.0);
    }
    return grid_of_affine(lps, dims);
}

VolumeGrid grid_of(const NiftiHeader& header, const std::filesystem::path& file, const glm::ivec3& dims,
                   const Reading& reading) {
    if (header.version < 2) {
        try {
            VolumeGrid grid = read_itk_header(ItkFormat::nifti, file).grid;
            grid.dims = dims;
            return grid;
        } catch (const std::exception& error) {
            if (header.sform <= 0) {
                reading.fail(error.what());
            }
            reading.log.info(reading.file.string() +
                             ": its axes are not orthonormal; the sform is taken as it is");
        }
    }
    return own_grid(header, dims);
}

/// ITK decomposes whatever the sform holds.
bool all_finite(const NiftiHeader& header) {
    bool finite = true;
    for (int i = 0; i < 3; ++i) {
        finite = finite && std::isfinite(header.quaternion[i]) && std::isfinite(header.offset[i]);
        for (int column = 0; column < 4; ++column) {
            finite = finite && std::isfinite(header.srow[i][column]);
        }
    }
    return finite;
}

/// Sizes, type and channels; the spacing on disk has to hold before anything else looks at it.
VolumeHead head_of(const NiftiHeader& header, const Reading& reading) {
    const auto axes = header.dim[0];
    if (axes < 1 || axes > 7) {
        reading.fail("dim: " + std::to_string(axes) + " axes are not 1 to 7");
    }
    std::vector<double> sizes;
    for (std::int64_t axis = 1; axis <= axes; ++axis) {
        sizes.push_back(static_cast<double>(header.dim.at(static_cast<std::size_t>(axis))));
    }
    VolumeHead head;
    const glm::ivec3 dims = dims_of(sizes, "dim", reading);
    for (std::size_t axis = 1; axis <= std::min<std::size_t>(3, sizes.size()); ++axis) {
        const double spacing = header.pixdim.at(axis);
        if (!std::isfinite(spacing) || spacing == 0.0) {
            reading.fail("pixdim: spacing " + std::to_string(spacing) + " of axis " + std::to_string(axis) +
                         " must be finite and not 0");
        }
    }
    if (!all_finite(header)) {
        reading.fail("the quaternion, offset or rows of its orientation are not finite");
    }
    const VoxelType type = voxel_type(header.datatype, reading);
    head.type = type.type;
    head.volume.channels = type.channels;
    head.big_endian = header.big_endian;
    sizes.resize(7, 1.0);
    if (sizes[3] == 1.0 && sizes[4] >= 2.0 && sizes[4] <= 4.0 && type.channels == 1) {
        head.volume.channels = static_cast<int>(sizes[4]);
        head.planar = true;
    } else if (sizes[3] * sizes[4] * sizes[5] * sizes[6] > 1.0) {
        reading.log.warning(reading.file.string() + ": holds several volumes; the first is read");
    }
    if (std::isfinite(header.slope) && header.slope != 0.0) {
        head.volume.slope = header.slope;
        head.volume.intercept = header.intercept;
    }
    head.volume.grid.dims = dims;
    return head;
}

/// image.hdr -> image.img, image.nii.gz -> image.nii.gz
std::filesystem::path with_suffix(const std::filesystem::path& file, std::string_view suffix) {
    std::filesystem::path base = file;
    if (lower_extension(base) == ".gz") {
        base.replace_extension();
    }
    return base.replace_extension(suffix);
}

}  // namespace

Volume read_nifti(const Reading& reading) {
    // Either file of a pair may be named.
    const std::string extension = lower_extension(reading.file);
    const bool is_image = extension == ".img" || reading.file.string().ends_with(".img.gz");
    const std::filesystem::path header_file = is_image ? with_suffix(reading.file, ".hdr") : reading.file;
    const std::string start = first_bytes(header_file, 2);
    const Packing packing = start == "\x1f\x8b" ? Packing::zlib : Packing::none;
    const NiftiHeader header = parse(header_bytes({header_file, 0, packing}, reading), reading);
    VolumeHead head = head_of(header, reading);
    head.volume.grid.spacing_mm = glm::dvec3(1.0);
    const std::uint64_t due = head.bytes(reading);
    constexpr double most_offset = 1e12;
    if (!(header.voxel_offset >= 0.0 && header.voxel_offset <= most_offset)) {
        reading.fail("vox_offset " + std::to_string(header.voxel_offset) + " is out of range");
    }
    const auto offset = static_cast<std::uint64_t>(header.voxel_offset);

    Payload payload{header_file, offset, packing};
    if (!header.single_file) {
        payload.file = with_suffix(header_file, ".img");
        if (!std::filesystem::exists(payload.file)) {
            payload.file += ".gz";
            payload.packing = Packing::zlib;
        }
    }
    if (payload.packing == Packing::none) {
        const ReadBytes voxels = open_payload(payload, due, reading);
        head.volume.grid = grid_of(header, header_file, head.volume.grid.dims, reading);
        return read_voxels(head, voxels, reading);
    }
    payload.offset = 0;
    const ReadBytes voxels = open_payload(payload, due + offset, reading);
    head.volume.grid = grid_of(header, header_file, head.volume.grid.dims, reading);
    std::vector<std::byte> before(std::size_t{1} << 16U);
    for (std::uint64_t at = 0; at < offset;) {
        const std::uint64_t step = std::min<std::uint64_t>(before.size(), offset - at);
        voxels(std::span(before).first(step));
        at += step;
    }
    return read_voxels(head, voxels, reading);
}

}  // namespace viscera::io

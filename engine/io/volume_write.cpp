#include <nifti/nifti1.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "engine/core/error.h"
#include "engine/core/json_text.h"
#include "engine/io/file_bytes.h"
#include "engine/io/volume.h"
#include "engine/io/volume_shape_keys.h"
#include "engine/io/volume_text.h"

namespace viscera::io {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& message) {
    throw Error(ErrorCode::file, file.string(), message);
}

std::string text_of(const glm::dvec3& v, std::string_view between = " ") {
    return number_text(v.x) + std::string(between) + number_text(v.y) + std::string(between) +
           number_text(v.z);
}

std::string text_of(const glm::ivec3& v) {
    return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

/// One line of a header: a unit with line ends in it would be several.
std::string one_line(std::string_view text) {
    std::string line(trim(text));
    std::ranges::replace_if(
        line, [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return line;
}

enum class Wrapper : int { zlib = 15, gzip = 31 };  ///< window bits, with 16 added for gzip

std::string deflated(std::string_view head, std::span<const std::byte> body, Wrapper wrapper,
                     const std::filesystem::path& file) {
    constexpr int fast = 3;
    constexpr int memory = 8;
    constexpr std::size_t chunk = std::size_t{1} << 18U;
    z_stream stream{};
    if (deflateInit2(&stream, fast, Z_DEFLATED, static_cast<int>(wrapper), memory, Z_DEFAULT_STRATEGY) !=
        Z_OK) {
        fail(file, "cannot be packed");
    }
    std::string packed;
    std::array<Bytef, chunk> out;
    const auto feed = [&](const void* bytes, std::size_t size, int flush) {
        stream.next_in = const_cast<Bytef*>(static_cast<const Bytef*>(bytes));
        stream.avail_in = static_cast<uInt>(size);
        do {
            stream.next_out = out.data();
            stream.avail_out = static_cast<uInt>(out.size());
            deflate(&stream, flush);
            packed.append(reinterpret_cast<const char*>(out.data()), out.size() - stream.avail_out);
        } while (stream.avail_out == 0);
    };
    feed(head.data(), head.size(), Z_NO_FLUSH);
    for (std::size_t at = 0; at < body.size(); at += chunk) {
        feed(body.data() + at, std::min(chunk, body.size() - at), Z_NO_FLUSH);
    }
    feed(nullptr, 0, Z_FINISH);
    deflateEnd(&stream);
    return packed;
}

/// NRRD and MetaImage have no fields for rescale and unit that all programs share. In NRRD they are key/value
/// pairs; MetaImage has a pair of fields for the rescale.
std::string nrrd(const Volume& volume, const std::filesystem::path& file) {
    constexpr std::array<std::string_view, 5> types{"uint8", "int8", "uint16", "int16", "float"};
    const bool many = volume.channels > 1;
    const auto axis = [&](int a) {
        return "(" + text_of(volume.grid.direction[a] * volume.grid.spacing_mm[a], ",") + ")";
    };
    std::string text = "NRRD0005\ntype: " + std::string(types.at(static_cast<std::size_t>(volume.type)));
    text += "\ndimension: " + std::string(many ? "4" : "3") + "\nspace: left-posterior-superior\nsizes: " +
            (many ? std::to_string(volume.channels) + " " : "") + text_of(volume.grid.dims);
    text +=
        "\nspace directions: " + std::string(many ? "none " : "") + axis(0) + " " + axis(1) + " " + axis(2);
    text += "\nkinds: " + std::string(many ? "vector " : "") + "domain domain domain";
    text += "\nendian: little\nencoding: gzip\nspace origin: (" + text_of(volume.grid.origin_mm, ",") + ")\n";
    if (volume.slope != 1.0 || volume.intercept != 0.0) {
        text += "rescale_slope:=" + number_text(volume.slope) +
                "\nrescale_intercept:=" + number_text(volume.intercept) + "\n";
    }
    if (!volume.unit.empty()) {
        text += "unit:=" + one_line(volume.unit) + "\n";
    }
    return text + keys_of(volume.grid.shape) + "\n" + deflated("", volume.voxels, Wrapper::gzip, file);
}

std::string meta_image(const Volume& volume, const std::filesystem::path& file) {
    constexpr std::array<std::string_view, 5> types{"MET_UCHAR", "MET_CHAR", "MET_USHORT", "MET_SHORT",
                                                    "MET_FLOAT"};
    const std::string packed = deflated("", volume.voxels, Wrapper::zlib, file);
    const VolumeGrid& grid = volume.grid;
    std::string text =
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = "
        "True\n"
        "CompressedDataSize = " +
        std::to_string(packed.size());
    text += "\nTransformMatrix = " + text_of(grid.direction[0]) + " " + text_of(grid.direction[1]) + " " +
            text_of(grid.direction[2]);
    text += "\nOffset = " + text_of(grid.origin_mm) +
            "\nCenterOfRotation = 0 0 0\nElementSpacing = " + text_of(grid.spacing_mm) +
            "\nDimSize = " + text_of(grid.dims);
    if (volume.slope != 1.0 || volume.intercept != 0.0) {
        text += "\nElementToIntensityFunctionSlope = " + number_text(volume.slope) +
                "\nElementToIntensityFunctionOffset = " + number_text(volume.intercept);
    }
    if (!volume.unit.empty()) {
        text += "\nUnit = " + one_line(volume.unit);
    }
    if (volume.channels > 1) {
        text += "\nElementNumberOfChannels = " + std::to_string(volume.channels);
    }
    text += "\nElementType = " + std::string(types.at(static_cast<std::size_t>(volume.type)));
    return text + "\nElementDataFile = LOCAL\n" + packed;
}

std::int16_t nifti_type(const Volume& volume, const std::filesystem::path& file) {
    if (volume.channels == 1) {
        constexpr std::array<std::int16_t, 5> types{DT_UINT8, DT_INT8, DT_UINT16, DT_INT16, DT_FLOAT32};
        return types.at(static_cast<std::size_t>(volume.type));
    }
    if (volume.type != ScalarType::u8 || volume.channels == 2) {
        fail(file, "NIfTI holds one channel, or three or four of 8 bits; .nrrd and .mha hold others");
    }
    return volume.channels == 3 ? DT_RGB24 : DT_RGBA32;
}

std::string nifti(const Volume& volume, const std::filesystem::path& file) {
    const VolumeGrid& grid = volume.grid;
    nifti_1_header header{};
    header.sizeof_hdr = sizeof header;
    header.dim[0] = 3;
    header.pixdim[0] = 1.0F;
    for (int axis = 0; axis < 3; ++axis) {
        if (grid.dims[axis] > std::numeric_limits<std::int16_t>::max()) {
            fail(file, "NIfTI-1 holds at most 32767 voxels along an axis; .nrrd and .mha hold more");
        }
        header.dim[axis + 1] = static_cast<std::int16_t>(grid.dims[axis]);
        header.pixdim[axis + 1] = static_cast<float>(grid.spacing_mm[axis]);
    }
    std::fill(header.dim + 4, header.dim + 8, std::int16_t{1});
    header.datatype = nifti_type(volume, file);
    header.bitpix = static_cast<std::int16_t>(8 * volume.channels * static_cast<int>(bytes_of(volume.type)));
    constexpr std::size_t voxel_offset = 352;  // the header and four bytes that say: no extensions
    header.vox_offset = voxel_offset;
    header.scl_slope = static_cast<float>(volume.slope);
    header.scl_inter = static_cast<float>(volume.intercept);
    header.xyzt_units = NIFTI_UNITS_MM;
    header.sform_code = NIFTI_XFORM_SCANNER_ANAT;
    const glm::dmat4 lps = grid.index_to_world();
    for (int column = 0; column < 4; ++column) {
        header.srow_x[column] = static_cast<float>(-lps[column].x);
        header.srow_y[column] = static_cast<float>(-lps[column].y);
        header.srow_z[column] = static_cast<float>(lps[column].z);
    }
    std::memcpy(header.magic, "n+1", 4);
    std::string bytes(voxel_offset, '\0');
    std::memcpy(bytes.data(), &header, sizeof header);
    return deflated(bytes, volume.voxels, Wrapper::gzip, file);
}

}  // namespace

void write_volume(const Volume& volume, const std::filesystem::path& file) {
    volume.validate();
    const std::string name = lower(file.filename().string());
    if (name.ends_with(".nrrd")) {
        write_file(file, nrrd(volume, file));
    } else if (volume.grid.curvilinear()) {
        fail(file, "a volume that is " + std::string(to_string(volume.grid.shape.kind)) +
                       " is written as .nrrd, which can hold its geometry");
    } else if (name.ends_with(".mha")) {
        write_file(file, meta_image(volume, file));
    } else if (name.ends_with(".nii.gz")) {
        write_file(file, nifti(volume, file));
    } else {
        fail(file, "volumes are written as .nrrd, .mha or .nii.gz");
    }
}

}  // namespace viscera::io

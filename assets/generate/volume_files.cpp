#include "assets/generate/volume_files.h"

#include <zlib.h>

#include <array>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <string>

#include "assets/generate/write_file.h"

namespace viscera::assets {
namespace {

enum class Wrapper : int { zlib = 0, gzip = 16 };  ///< what deflate adds to its largest window size

std::string compressed(const std::vector<std::byte>& bytes, Wrapper wrapper) {
    z_stream stream{};
    // The fastest level: noise does not compress, and everything else does anyhow.
    if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, MAX_WBITS + static_cast<int>(wrapper), 8,
                     Z_DEFAULT_STRATEGY) != Z_OK) {
        throw std::runtime_error("zlib cannot start");
    }
    std::string packed(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<z_const Bytef*>(const_cast<std::byte*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    const int state = deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    if (state != Z_STREAM_END) {
        throw std::runtime_error("zlib cannot compress");
    }
    return packed;
}

/// Shortest text that reads back as the same number, as far as 12 digits go.
std::string text_of(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.12g", value);
    return text.data();
}

std::string joined(double x, double y, double z, const char* between) {
    return text_of(x) + between + text_of(y) + between + text_of(z);
}

std::string meta_image(const Volume& v) {
    const VolumeGrid& g = v.grid;
    constexpr std::array<const char*, 5> types{"MET_UCHAR", "MET_CHAR", "MET_USHORT", "MET_SHORT",
                                               "MET_FLOAT"};
    const std::string data = compressed(v.voxels, Wrapper::zlib);
    std::string axes;
    for (int axis = 0; axis < 3; ++axis) {
        axes += (axis > 0 ? " " : "") +
                joined(g.direction[axis].x, g.direction[axis].y, g.direction[axis].z, " ");
    }
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
           "CompressedData = True\nCompressedDataSize = " +
           std::to_string(data.size()) + "\nTransformMatrix = " + axes +
           "\nOffset = " + joined(g.origin_mm.x, g.origin_mm.y, g.origin_mm.z, " ") +
           "\nAnatomicalOrientation = RAI\nElementSpacing = " +
           joined(g.spacing_mm.x, g.spacing_mm.y, g.spacing_mm.z, " ") +
           "\nDimSize = " + joined(g.dims.x, g.dims.y, g.dims.z, " ") +
           "\nElementType = " + types.at(static_cast<std::size_t>(v.type)) + "\nElementDataFile = LOCAL\n" +
           data;
}

/// How samples lie on cylinders and spheres, as docs/conventions.md describes it.
std::string geometry_keys(const VolumeShape& shape) {
    if (!shape.curvilinear()) {
        return "";
    }
    constexpr double degrees = 180.0 / std::numbers::pi;
    const bool cylindrical = shape.kind == VolumeKind::cylindrical;
    return std::string("viscera_geometry:=") + (cylindrical ? "cylindrical" : "spherical") +
           "\nviscera_r_min_mm:=" + text_of(shape.r_min_mm) +
           "\nviscera_r_max_mm:=" + text_of(shape.r_max_mm) +
           "\nviscera_first_angle_deg:=" + text_of(degrees * shape.first_angle_rad) +
           "\nviscera_angle_deg:=" + text_of(degrees * shape.angle_rad) +
           "\nviscera_wrap:=" + (shape.wrap ? "true" : "false") +
           (cylindrical ? "\nviscera_height_mm:=" + text_of(shape.height_mm)
                        : "\nviscera_latitude_deg:=" + text_of(degrees * shape.latitude_rad)) +
           "\n";
}

std::string nrrd(const Volume& v) {
    const VolumeGrid& g = v.grid;
    constexpr std::array<const char*, 5> types{"uint8", "int8", "uint16", "int16", "float"};
    std::string axes;
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 step = g.direction[axis] * g.spacing_mm[axis];
        axes += " (" + joined(step.x, step.y, step.z, ",") + ")";
    }
    const bool coloured = v.channels > 1;
    return std::string("NRRD0004\ntype: ") + types.at(static_cast<std::size_t>(v.type)) +
           "\ndimension: " + (coloured ? "4" : "3") +
           "\nspace: left-posterior-superior\nsizes: " + (coloured ? std::to_string(v.channels) + " " : "") +
           joined(g.dims.x, g.dims.y, g.dims.z, " ") + "\nspace directions:" + (coloured ? " none" : "") +
           axes + "\nkinds: " + (coloured ? "vector " : "") +
           "domain domain domain\nendian: little\nencoding: gzip\nspace origin: (" +
           joined(g.origin_mm.x, g.origin_mm.y, g.origin_mm.z, ",") + ")\n" + geometry_keys(g.shape) + "\n" +
           compressed(v.voxels, Wrapper::gzip);
}

}  // namespace

void write_volume(const Volume& volume, const std::filesystem::path& path) {
    write_file(path, path.extension() == ".nrrd" ? nrrd(volume) : meta_image(volume));
}

}  // namespace viscera::assets

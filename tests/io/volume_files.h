#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "engine/core/volume.h"
#include "tests/io/sample_files.h"

namespace viscera::test {

/// Packed with zlib (window bits 15), gzip (31) or without either's header (-15).
inline std::string deflated(std::string_view bytes, int window_bits) {
    z_stream stream{};
    deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY);
    std::string packed(bytes.size() + bytes.size() / 100 + 100, '\0');
    std::string input(bytes);
    stream.next_in = reinterpret_cast<Bytef*>(input.data());
    stream.avail_in = static_cast<uInt>(input.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

/// The values 0, 1, 2, ... of a volume of 4 x 3 x 2 voxels.
template <class T>
std::vector<T> ramp(std::size_t count = 24) {
    std::vector<T> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        values[i] = static_cast<T>(i);
    }
    return values;
}

/// The bytes of each value turned over.
template <class T>
std::string big_endian(const std::vector<T>& values) {
    std::string bytes;
    for (const T value : values) {
        const std::string one = bytes_of(value);
        bytes.append(one.rbegin(), one.rend());
    }
    return bytes;
}

inline std::string mha(std::string_view type, const std::string& payload, std::string_view extra = "") {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n" +
           std::string(extra) +
           "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 0.5 0.75 2\n"
           "DimSize = 4 3 2\nElementType = " +
           std::string(type) + "\nElementDataFile = LOCAL\n" + payload;
}

/// An NRRD of 4 x 3 x 2 voxels with spacing 0.5, 0.75 and 2 along the axes of its space.
inline std::string nrrd(std::string_view type, std::string_view encoding, const std::string& payload,
                        std::string_view space = "left-posterior-superior", std::string_view extra = "") {
    return "NRRD0004\n# a comment\ntype: " + std::string(type) +
           "\ndimension: 3\nspace: " + std::string(space) +
           "\nsizes: 4 3 2\nspace directions: (0.5,0,0) (0,0.75,0) (0,0,2)\nkinds: domain domain domain\n"
           "endian: little\nencoding: " +
           std::string(encoding) + "\nspace origin: (10,20,30)\n" + std::string(extra) + "\n" + payload;
}

/// A NIfTI-1 header of 4 x 3 x 2 voxels, to be changed and followed by its voxels at byte 352.
struct Nifti {
    std::string bytes = std::string(352, '\0');

    Nifti(std::int16_t type, std::int16_t bits) {
        set(0, std::int32_t{348});
        const std::int16_t dims[8]{3, 4, 3, 2, 1, 1, 1, 1};
        const float spacing[8]{1, 0.5F, 0.75F, 2, 1, 1, 1, 1};
        for (std::size_t i = 0; i < 8; ++i) {
            set(40 + 2 * i, dims[i]);
            set(76 + 4 * i, spacing[i]);
        }
        set(70, type);
        set(72, bits);
        set(108, 352.0F);
        bytes[123] = 2;  // mm
        bytes.replace(344, 4, std::string("n+1\0", 4));
        sform({0.5F, 0, 0, 10}, {0, 0.75F, 0, 20}, {0, 0, 2, 30});
    }
    template <class T>
    void set(std::size_t at, T value) {
        std::memcpy(bytes.data() + at, &value, sizeof value);
    }
    void sform(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z) {
        set(254, std::int16_t{1});
        for (std::size_t i = 0; i < 4; ++i) {
            set(280 + 4 * i, x[i]);
            set(296 + 4 * i, y[i]);
            set(312 + 4 * i, z[i]);
        }
    }
};

inline std::string legacy_vtk(std::string_view coding, std::string_view type, const std::string& payload,
                              std::string_view components = "") {
    return "# vtk DataFile Version 3.0\ntitle\n" + std::string(coding) +
           "\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 3 2\nSPACING 0.5 0.75 2\nORIGIN 10 20 30\nPOINT_DATA "
           "24\n"
           "SCALARS density " +
           std::string(type) + " " + std::string(components) + "\nLOOKUP_TABLE default\n" + payload;
}

/// An ImageData file around a DataArray and what is appended.
inline std::string vti(std::string_view array, std::string_view attributes = "",
                       std::string_view appended = "", std::string_view image = "") {
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" " + std::string(attributes) +
           "><ImageData WholeExtent=\"0 3 0 2 0 1\" Origin=\"10 20 30\" Spacing=\"0.5 0.75 2\" " +
           std::string(image) + "><Piece Extent=\"0 3 0 2 0 1\"><PointData Scalars=\"density\">" +
           std::string(array) + "</PointData></Piece></ImageData>" + std::string(appended) + "</VTKFile>\n";
}

template <class T>
std::string ramp_text(std::string_view between = " ") {
    std::string text;
    for (const T value : ramp<T>()) {
        text += std::to_string(static_cast<int>(value)) + std::string(between);
    }
    return text;
}

inline std::string csv() {
    std::string text = "x,y,z,value\n";
    for (int i = 0; i < 24; ++i) {
        text += std::to_string(10.0 + 0.5 * (i % 4)) + "," + std::to_string(20.0 + 0.75 * (i / 4 % 3)) + "," +
                std::to_string(30.0 + 2.0 * (i / 12)) + "," + std::to_string(i) + "\n";
    }
    return text;
}

/// The bytes of each number of `width` bytes turned over.
inline std::string turned(std::string bytes, std::size_t width) {
    for (std::size_t at = 0; at + width <= bytes.size(); at += width) {
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                     bytes.begin() + static_cast<std::ptrdiff_t>(at + width));
    }
    return bytes;
}

enum class DicomCoding { little, big, deflated };

/// One element of a DICOM file with explicit types; `value` in little-endian order.
inline std::string dicom_element(std::uint16_t group, std::uint16_t element, std::string_view type,
                                 std::string value, DicomCoding coding = DicomCoding::little) {
    if (value.size() % 2 == 1) {
        value += type == "UI" || type == "OW" || type == "OB" ? '\0' : ' ';
    }
    const auto in_order = [&](auto number) {
        const std::string bytes = bytes_of(number);
        return coding == DicomCoding::big ? turned(bytes, bytes.size()) : bytes;
    };
    if (coding == DicomCoding::big) {
        value = turned(value, type == "US" || type == "OW" ? 2 : type == "UL" ? 4 : 1);
    }
    const std::string tag = in_order(group) + in_order(element) + std::string(type);
    if (type == "OW" || type == "OB" || type == "SQ") {
        return tag + std::string(2, '\0') + in_order(static_cast<std::uint32_t>(value.size())) + value;
    }
    return tag + in_order(static_cast<std::uint16_t>(value.size())) + value;
}

/// The value of a sequence with one item.
inline std::string dicom_item(const std::string& elements, DicomCoding coding) {
    const auto words = bytes_of(std::vector<std::uint16_t>{0xfffe, 0xe000});
    const auto size = bytes_of(static_cast<std::uint32_t>(elements.size()));
    return coding == DicomCoding::big ? turned(words, 2) + turned(size, 4) + elements
                                      : words + size + elements;
}

struct DicomSlice {
    std::string series = "1.2.3.4";
    std::string position = R"(10\20\30)";
    std::string orientation = R"(1\0\0\0\1\0)";
    std::string slope = "1";
    std::string intercept = "-1024";
    int instance = 1;
    std::vector<std::uint16_t> pixels = ramp<std::uint16_t>(12);  ///< 4 x 3
    DicomCoding coding = DicomCoding::little;
    std::string_view pixel_type = "OW";
    bool bytes = false;  ///< the pixels as 8 bits
    bool is_signed = false;
};

inline std::string dicom(const DicomSlice& slice) {
    const auto put = [&](std::uint16_t group, std::uint16_t element, std::string_view type,
                         const std::string& value) {
        return dicom_element(group, element, type, value, slice.coding);
    };
    const auto us = [&](std::uint16_t group, std::uint16_t element, std::uint16_t value) {
        return put(group, element, "US", bytes_of(value));
    };
    const std::string sop = "1.2.840.10008.5.1.4.1.1.2";
    const std::string instance = "1.2.3.5." + std::to_string(slice.instance);
    const std::string syntax = slice.coding == DicomCoding::little ? "1.2.840.10008.1.2.1"
                               : slice.coding == DicomCoding::big  ? "1.2.840.10008.1.2.2"
                                                                   : "1.2.840.10008.1.2.1.99";
    const std::string meta = dicom_element(2, 1, "OB", std::string("\0\1", 2)) +
                             dicom_element(2, 2, "UI", sop) + dicom_element(2, 3, "UI", instance) +
                             dicom_element(2, 0x10, "UI", syntax) + dicom_element(2, 0x12, "UI", "1.2.3");
    const std::uint16_t bits = slice.bytes ? 8 : slice.is_signed ? 16 : 12;
    const std::string elements =
        put(8, 0x16, "UI", sop) + put(8, 0x18, "UI", instance) + put(8, 0x60, "CS", "CT") +
        put(8, 0x1140, "SQ", dicom_item(put(8, 0x1150, "UI", sop) + us(8, 0x9999, 7), slice.coding)) +
        put(0x18, 0x50, "DS", "2") + put(0x20, 0xd, "UI", "1.2.3") + put(0x20, 0xe, "UI", slice.series) +
        put(0x20, 0x13, "IS", std::to_string(slice.instance)) + put(0x20, 0x32, "DS", slice.position) +
        put(0x20, 0x37, "DS", slice.orientation) + us(0x28, 2, 1) + put(0x28, 4, "CS", "MONOCHROME2") +
        us(0x28, 0x10, 3) + us(0x28, 0x11, 4) + put(0x28, 0x30, "DS", R"(0.75\0.5)") +
        us(0x28, 0x100, slice.bytes ? 8 : 16) + us(0x28, 0x101, bits) +
        us(0x28, 0x102, static_cast<std::uint16_t>(bits - 1)) + us(0x28, 0x103, slice.is_signed ? 1 : 0) +
        put(0x28, 0x1052, "DS", slice.intercept) + put(0x28, 0x1053, "DS", slice.slope) +
        put(0x7fe0, 0x10, slice.pixel_type,
            slice.bytes ? bytes_of(std::vector<std::uint8_t>(slice.pixels.begin(), slice.pixels.end()))
                        : bytes_of(slice.pixels));
    return std::string(128, '\0') + "DICM" +
           dicom_element(2, 0, "UL", bytes_of(static_cast<std::uint32_t>(meta.size()))) + meta +
           (slice.coding == DicomCoding::deflated ? deflated(elements, -15) : elements);
}

}  // namespace viscera::test

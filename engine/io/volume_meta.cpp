#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "engine/core/error.h"
#include "engine/io/volume_itk.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_text.h"
#include "engine/io/words.h"

namespace viscera::io {

namespace {

using Fields = std::map<std::string, std::string, std::less<>>;

/// The fields of a header and where it ends. Sequences write fields for each frame, so it may be long.
struct MetaHeader {
    Fields fields;
    std::uint64_t end = 0;

    [[nodiscard]] std::string_view get(std::initializer_list<std::string_view> names) const {
        for (const std::string_view name : names) {
            if (const auto found = fields.find(name); found != fields.end()) {
                return found->second;
            }
        }
        return {};
    }
    [[nodiscard]] bool is_true(std::initializer_list<std::string_view> names) const {
        const std::string_view value = get(names);
        return value.starts_with('T') || value.starts_with('t') || value.starts_with('1');
    }
};

MetaHeader scan(const std::filesystem::path& file) {
    constexpr std::size_t most_header = std::size_t{16} << 20U;
    MetaHeader header;
    for (const std::size_t size : {std::size_t{1} << 16U, most_header}) {
        const std::string bytes = first_bytes(file, size);
        header = {};
        for (std::string_view rest = bytes; !rest.empty();) {
            const std::string_view line = take_line(rest);
            const std::size_t sign = line.find('=');
            if (sign == std::string_view::npos) {
                continue;
            }
            const std::string key(trim(line.substr(0, sign)));
            header.fields[key] = trim(line.substr(sign + 1));
            if (key == "ElementDataFile") {
                header.end = static_cast<std::uint64_t>(rest.data() - bytes.data());
                return header;
            }
        }
    }
    return header;
}

FileScalar element_type(std::string_view name, const Reading& reading) {
    static const std::map<std::string_view, FileScalar> types{
        {"MET_UCHAR", FileScalar::u8},       {"MET_CHAR", FileScalar::i8},
        {"MET_USHORT", FileScalar::u16},     {"MET_SHORT", FileScalar::i16},
        {"MET_UINT", FileScalar::u32},       {"MET_INT", FileScalar::i32},
        {"MET_ULONG", FileScalar::u32},      {"MET_LONG", FileScalar::i32},
        {"MET_ULONG_LONG", FileScalar::u64}, {"MET_LONG_LONG", FileScalar::i64},
        {"MET_FLOAT", FileScalar::f32},      {"MET_DOUBLE", FileScalar::f64}};
    if (name.ends_with("_ARRAY")) {
        name.remove_suffix(6);
    }
    const auto found = types.find(name);
    if (found == types.end()) {
        reading.fail("ElementType '" + printable(name) + "' is not read");
    }
    return found->second;
}

/// Where ITK only says that the file cannot be read, or takes what is none.
void check_numbers(const MetaHeader& header, std::initializer_list<std::string_view> names, bool positive,
                   const Reading& reading) {
    const std::string_view text = header.get(names);
    if (text.empty()) {
        return;
    }
    for (const double number : numbers_of(text, *names.begin(), reading)) {
        if (!std::isfinite(number) || (positive && number <= 0.0)) {
            reading.fail(std::string(*names.begin()) + ": '" + printable(text) + "' must be finite" +
                         (positive ? " and more than 0 (spacing)" : ""));
        }
    }
}

VolumeHead head_of(const MetaHeader& header, const Reading& reading) {
    VolumeHead head;
    const std::vector<double> dims = numbers_of(header.get({"DimSize"}), "DimSize", reading);
    const std::vector<double> axes = numbers_of(header.get({"NDims"}), "NDims", reading);
    if (axes.size() != 1 || axes[0] != static_cast<double>(dims.size()) || dims.size() < 2 ||
        dims.size() > 4) {
        reading.fail("NDims and DimSize do not say a volume of 2 to 4 axes");
    }
    head.volume.grid.dims = dims_of(dims, "DimSize", reading);
    check_numbers(header, {"ElementSpacing"}, true, reading);
    check_numbers(header, {"ElementSize"}, true, reading);
    check_numbers(header, {"Offset", "Position", "Origin"}, false, reading);
    check_numbers(header, {"TransformMatrix", "Rotation", "Orientation"}, false, reading);
    head.type = element_type(header.get({"ElementType"}), reading);
    if (const std::string_view channels = header.get({"ElementNumberOfChannels"}); !channels.empty()) {
        head.volume.channels =
            static_cast<int>(whole_number(channels, "ElementNumberOfChannels", 1.0, 4.0, reading));
    }
    head.big_endian = header.is_true({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"});
    if (const std::string_view slope = header.get({"ElementToIntensityFunctionSlope"}); !slope.empty()) {
        head.volume.slope = one_number(slope, "ElementToIntensityFunctionSlope", reading);
    }
    if (const std::string_view offset = header.get({"ElementToIntensityFunctionOffset"}); !offset.empty()) {
        head.volume.intercept = one_number(offset, "ElementToIntensityFunctionOffset", reading);
    }
    head.volume.unit = header.get({"Unit"});
    if (dims.size() == 4 && dims[3] > 1.0) {
        reading.log.warning(reading.file.string() + ": holds " + std::to_string(static_cast<int>(dims[3])) +
                            " volumes; the first is read");
    }
    return head;
}

/// Letters of AnatomicalOrientation name the side from which each axis comes. ITK takes the matrix only, and
/// so does this reader; files whose letters say something else are told apart here.
void compare_orientation(const MetaHeader& header, const VolumeGrid& grid, const Reading& reading) {
    const std::string_view letters = header.get({"AnatomicalOrientation"});
    if (letters.size() != 3 || letters.find('?') != std::string_view::npos) {
        return;
    }
    std::string from;
    std::string to;
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 along = grid.direction[axis];
        const glm::dvec3 size = glm::abs(along);
        const int largest = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const bool positive = along[largest] > 0.0;
        from += "RAI"[largest];
        to += "LPS"[largest];
        if (!positive) {
            std::swap(from.back(), to.back());
        }
    }
    // Programs disagree on whether the letters say where an axis comes from or where it goes.
    if (letters != from && letters != to) {
        reading.log.warning(reading.file.string() + ": AnatomicalOrientation " + printable(letters) +
                            " contradicts TransformMatrix (" + from + "), which is taken");
    }
}

void take_orientation(VolumeHead& head, const ItkHeader& itk, const Reading& reading) {
    const glm::ivec3 dims = head.volume.grid.dims;
    for (std::size_t axis = 0; axis < std::min<std::size_t>(itk.dims.size(), 3); ++axis) {
        if (itk.dims[axis] != static_cast<std::uint64_t>(dims[static_cast<int>(axis)])) {
            reading.fail("DimSize is given twice, differently");
        }
    }
    head.volume.grid = itk.grid;
    head.volume.grid.dims = dims;
}

/// Files of a numbered series or a list, one for each slice.
std::vector<std::string> slice_names(std::string_view name, const MetaHeader& header, const VolumeHead& head,
                                     const Reading& reading) {
    const auto slices = static_cast<std::size_t>(head.volume.grid.dims.z);
    std::optional<NumberedFiles> numbered;
    if (name.find('%') != std::string_view::npos) {
        numbered = numbered_files(name, "ElementDataFile", reading);
    }
    std::vector<std::string> names;
    if (name.starts_with("LIST")) {
        constexpr std::size_t most_text = std::size_t{1} << 22U;
        const std::string bytes = first_bytes(reading.file, most_text);
        std::string_view rest =
            std::string_view(bytes).substr(std::min<std::size_t>(header.end, bytes.size()));
        while (!rest.empty() && names.size() < slices) {
            names.emplace_back(trim(take_line(rest)));
        }
    } else if (numbered) {
        const std::size_t count = numbered->count();
        for (std::size_t file = 0; file < count && names.size() <= slices; ++file) {
            names.push_back(numbered->name(file));
        }
    } else {
        return names;
    }
    if (names.size() != slices) {
        reading.fail("ElementDataFile: is not one file for each slice");
    }
    return names;
}

/// ITK leaves a slice dark whose file is missing.
void expect_slices(const std::vector<std::string>& names, const Reading& reading) {
    for (const std::string& name : names) {
        const std::filesystem::path file = reading.file.parent_path() / name;
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(file, ignored)) {
            reading.fail("its voxels are to be in '" + file.string() + "', which is not a file");
        }
    }
}

Volume read_payload(const VolumeHead& head, const MetaHeader& header, const Reading& reading) {
    const std::string name(header.get({"ElementDataFile"}));
    const std::string_view header_size = header.get({"HeaderSize"});
    const bool plain = !header.fields.contains("BinaryData") || header.is_true({"BinaryData"});
    if (!plain || name.starts_with("LIST") || name.find('%') != std::string::npos) {
        expect_slices(slice_names(name, header, head, reading), reading);
        require_plausible(head, reading);
        const std::vector<std::byte> voxels = read_itk_voxels(ItkFormat::meta, head, reading);
        VolumeHead native = head;
        native.big_endian = false;
        return read_voxels(std::move(native), read_from_memory(voxels, reading), reading);
    }
    Payload payload{reading.file, header.end, Packing::none};
    if (name != "LOCAL" && name != "Local" && name != "local") {
        payload = {reading.file.parent_path() / name, 0, Packing::none};
    }
    const std::uint64_t due = head.bytes(reading);
    if (header.is_true({"CompressedData"})) {
        payload.packing = Packing::zlib;
    } else if (!header_size.empty()) {
        const double skip = one_number(header_size, "HeaderSize", reading);
        const std::uint64_t size = size_of(payload.file, reading);
        // -1: the voxels are the last bytes of the file.
        payload.offset = skip < 0.0 ? size - std::min(size, due)
                                    : payload.offset + static_cast<std::uint64_t>(std::min(skip, 1e15));
    }
    return read_voxels(head, open_payload(payload, due, reading), reading);
}

}  // namespace

Volume read_meta_image(const Reading& reading) {
    static_cast<void>(size_of(reading.file, reading));
    const MetaHeader header = scan(reading.file);
    if (header.end == 0) {
        reading.fail("its header has no ElementDataFile");
    }
    VolumeHead head = head_of(header, reading);
    static_cast<void>(head.bytes(reading));
    try {
        take_orientation(head, read_itk_header(ItkFormat::meta, reading.file), reading);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        reading.fail(error.what());
    }
    compare_orientation(header, head.volume.grid, reading);
    return read_payload(head, header, reading);
}

}  // namespace viscera::io

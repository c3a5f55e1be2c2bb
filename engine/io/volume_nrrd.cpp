#include <algorithm>
#include <map>
#include <optional>

#include "engine/core/error.h"
#include "engine/io/volume_itk.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_shape_keys.h"
#include "engine/io/volume_text.h"
#include "engine/io/words.h"

namespace viscera::io {

namespace {

struct NrrdHeader {
    std::map<std::string, std::string, std::less<>> fields;  ///< lower case, without spaces: "datafile"
    KeyValues values;                                        ///< key:=value
    std::uint64_t end = 0;                                   ///< first byte behind the empty line
    bool has_voxels = false;                                 ///< an empty line ended the header

    [[nodiscard]] std::string_view get(std::string_view name) const {
        const auto found = fields.find(name);
        return found == fields.end() ? std::string_view{} : found->second;
    }
};

std::string without_spaces(std::string_view text) {
    std::string result = lower(text);
    std::erase(result, ' ');
    return result;
}

NrrdHeader scan(const Reading& reading) {
    constexpr std::size_t most_header = std::size_t{1} << 20U;
    const std::string bytes = first_bytes(reading.file, most_header);
    if (!bytes.starts_with("NRRD")) {
        reading.fail("does not begin with NRRD");
    }
    NrrdHeader header;
    for (std::string_view rest = bytes; !rest.empty();) {
        const std::string_view line = take_line(rest);
        header.end = static_cast<std::uint64_t>(rest.data() - bytes.data());
        if (line.empty()) {
            header.has_voxels = true;
            break;
        }
        if (line.starts_with('#')) {
            continue;
        }
        // ITK puts what it does not understand into messages of a fixed size.
        constexpr std::size_t most_field = 800;
        if (line.size() > most_field && line.find(":=") == std::string_view::npos) {
            reading.fail("its header has a line of " + std::to_string(line.size()) + " bytes: '" +
                         printable(line) + "'");
        }
        const std::size_t colon = line.find(':');
        if (colon == std::string_view::npos) {
            continue;
        }
        const bool is_value = line.substr(colon).starts_with(":=");
        const std::string_view value = trim(line.substr(colon + (is_value ? 2 : 1)));
        if (is_value) {
            header.values[std::string(trim(line.substr(0, colon)))] = value;
        } else {
            header.fields[without_spaces(line.substr(0, colon))] = value;
        }
    }
    return header;
}

FileScalar nrrd_type(std::string_view name, const Reading& reading) {
    static const std::map<std::string, FileScalar, std::less<>> types{
        {"signedchar", FileScalar::i8},
        {"int8", FileScalar::i8},
        {"int8_t", FileScalar::i8},
        {"uchar", FileScalar::u8},
        {"unsignedchar", FileScalar::u8},
        {"uint8", FileScalar::u8},
        {"uint8_t", FileScalar::u8},
        {"short", FileScalar::i16},
        {"shortint", FileScalar::i16},
        {"signedshort", FileScalar::i16},
        {"signedshortint", FileScalar::i16},
        {"int16", FileScalar::i16},
        {"int16_t", FileScalar::i16},
        {"ushort", FileScalar::u16},
        {"unsignedshort", FileScalar::u16},
        {"unsignedshortint", FileScalar::u16},
        {"uint16", FileScalar::u16},
        {"uint16_t", FileScalar::u16},
        {"int", FileScalar::i32},
        {"signedint", FileScalar::i32},
        {"int32", FileScalar::i32},
        {"int32_t", FileScalar::i32},
        {"uint", FileScalar::u32},
        {"unsignedint", FileScalar::u32},
        {"uint32", FileScalar::u32},
        {"uint32_t", FileScalar::u32},
        {"longlong", FileScalar::i64},
        {"longlongint", FileScalar::i64},
        {"signedlonglong", FileScalar::i64},
        {"signedlonglongint", FileScalar::i64},
        {"int64", FileScalar::i64},
        {"int64_t", FileScalar::i64},
        {"ulonglong", FileScalar::u64},
        {"unsignedlonglong", FileScalar::u64},
        {"unsignedlonglongint", FileScalar::u64},
        {"uint64", FileScalar::u64},
        {"uint64_t", FileScalar::u64},
        {"float", FileScalar::f32},
        {"double", FileScalar::f64}};
    const auto found = types.find(without_spaces(name));
    if (found == types.end()) {
        reading.fail("type '" + printable(name) + "' is not read");
    }
    return found->second;
}

/// Which of the axes on disk hold the volume, and which holds channels.
struct Axes {
    glm::ivec3 dims{1};
    int channels = 1;
    bool is_plain = true;  ///< channels fastest, or none: the voxels lie as a Volume has them
};

Axes nrrd_axes(const std::vector<double>& sizes, const ItkHeader& itk, const Reading& reading) {
    const auto channels = static_cast<std::size_t>(itk.components);
    const bool first_is_channels =
        channels > 1 && sizes.size() == itk.dims.size() + 1 && sizes[0] == static_cast<double>(channels);
    Axes axes{.channels = itk.components, .is_plain = channels == 1 || first_is_channels};
    const std::vector<double> spatial(itk.dims.begin(), itk.dims.end());
    axes.dims = dims_of(spatial, "sizes", reading);
    if (axes.is_plain && !std::ranges::equal(spatial, std::span(sizes).subspan(first_is_channels ? 1 : 0))) {
        reading.fail("sizes are given twice, differently");
    }
    if (spatial.size() > 3 && spatial[3] > 1.0) {
        reading.log.warning(reading.file.string() + ": holds " +
                            std::to_string(static_cast<int>(spatial[3])) + " volumes; the first is read");
    }
    return axes;
}

/// Sizes from the header alone, checked against what a file can hold before a library sees them.
std::vector<double> checked_sizes(const NrrdHeader& header, const Reading& reading) {
    std::vector<double> sizes = numbers_of(header.get("sizes"), "sizes", reading);
    const double axes = whole_number(header.get("dimension"), "dimension", 2.0, 5.0, reading);
    if (axes != static_cast<double>(sizes.size())) {
        reading.fail("dimension and sizes do not agree");
    }
    static_cast<void>(dims_of(sizes, "sizes", reading));
    return sizes;
}

std::uint64_t skip_lines(const Payload& payload, std::uint64_t lines, const Reading& reading) {
    constexpr std::size_t most_text = std::size_t{1} << 24U;
    const std::string bytes = first_bytes(payload.file, payload.offset + most_text);
    std::size_t at = payload.offset;
    for (std::uint64_t line = 0; line < lines; ++line) {
        at = bytes.find('\n', at);
        if (at == std::string::npos) {
            reading.fail("line skip leads past the end of the file");
        }
        ++at;
    }
    return at;
}

/// One run of plain or gzipped bytes; none where ITK has to find and decode the voxels.
std::optional<Payload> payload_of(const NrrdHeader& header, std::uint64_t due, const Reading& reading) {
    const std::string encoding = lower(header.get("encoding"));
    const bool packed = encoding == "gzip" || encoding == "gz";
    const std::string name(header.get("datafile"));
    if ((!packed && encoding != "raw") || name.starts_with("LIST") || name.find('%') != std::string::npos) {
        return std::nullopt;
    }
    if (name.empty() && !header.has_voxels) {
        reading.fail("is truncated: its header does not end");
    }
    Payload payload{name.empty() ? reading.file : reading.file.parent_path() / name,
                    name.empty() ? header.end : 0, packed ? Packing::zlib : Packing::none};
    if (const std::string_view lines = header.get("lineskip"); !lines.empty()) {
        const double count = whole_number(lines, "line skip", 0.0, 1e6, reading);
        payload.offset = skip_lines(payload, static_cast<std::uint64_t>(count), reading);
    }
    if (const std::string_view bytes = header.get("byteskip"); !bytes.empty()) {
        const double count = whole_number(bytes, "byte skip", -1.0, 1e15, reading);
        if (packed && count != 0.0) {
            return std::nullopt;  // bytes of the unpacked stream
        }
        const std::uint64_t size = size_of(payload.file, reading);
        payload.offset =
            count < 0.0 ? size - std::min(size, due) : payload.offset + static_cast<std::uint64_t>(count);
    }
    return payload;
}

std::optional<double> value_of(const NrrdHeader& header, std::string_view key, const Reading& reading) {
    const auto found = header.values.find(key);
    if (found == header.values.end()) {
        return std::nullopt;
    }
    return one_number(found->second, key, reading);
}

/// Length of a unit that a field names; none for one that is not known.
std::optional<double> millimetres(std::string_view unit) {
    static const std::map<std::string, double, std::less<>> units{
        {"mm", 1.0},    {"millimeter", 1.0},  {"millimeters", 1.0}, {"millimetre", 1.0}, {"millimetres", 1.0},
        {"cm", 10.0},   {"centimeter", 10.0}, {"centimetre", 10.0}, {"m", 1e3},          {"meter", 1e3},
        {"metre", 1e3}, {"um", 1e-3},         {"micron", 1e-3},     {"microns", 1e-3},   {"micrometer", 1e-3},
        {"nm", 1e-6},   {"nanometer", 1e-6},  {"micrometre", 1e-3}, {"\xC2\xB5m", 1e-3}};
    const auto found = units.find(lower(unit));
    return found == units.end() ? std::nullopt : std::optional(found->second);
}

/// ITK takes all lengths as mm, whatever unit the file gives them in. Axes of one volume have one unit.
void apply_units(const NrrdHeader& header, VolumeGrid& grid, const Reading& reading) {
    std::optional<double> mm;
    const std::string_view field = header.get("space").empty() ? "units" : "spaceunits";
    std::string_view rest = header.get(field);
    for (std::size_t open = rest.find('"'); open != std::string_view::npos; open = rest.find('"')) {
        rest.remove_prefix(open + 1);
        const std::string_view unit = rest.substr(0, rest.find('"'));
        rest.remove_prefix(std::min(rest.size(), unit.size() + 1));
        const std::optional<double> length = millimetres(trim(unit));
        if (trim(unit).empty()) {
            continue;  // an axis without a unit, such as channels
        }
        if (!length || (mm && *mm != *length)) {
            reading.log.warning(reading.file.string() + ": lengths in '" + printable(header.get(field)) +
                                "' are taken as mm");
            return;
        }
        mm = length;
    }
    grid.spacing_mm *= mm.value_or(1.0);
    grid.origin_mm *= mm.value_or(1.0);
}

/// ITK 5.2 turns LAS over along x, where it is y that differs from LPS: half a turn about z sets it right.
void half_turn(VolumeGrid& grid) {
    const glm::dvec3 turn(-1.0, -1.0, 1.0);
    grid.origin_mm *= turn;
    for (int axis = 0; axis < 3; ++axis) {
        grid.direction[axis] *= turn;
    }
}

}  // namespace

Volume read_nrrd(const Reading& reading) {
    static_cast<void>(size_of(reading.file, reading));
    const NrrdHeader header = scan(reading);
    const std::vector<double> sizes = checked_sizes(header, reading);
    if (const std::string_view names = header.get("datafile"); names.find('%') != std::string_view::npos) {
        static_cast<void>(numbered_files(names, "data file", reading));
    }
    VolumeHead head;
    head.type = nrrd_type(header.get("type"), reading);
    head.big_endian = lower(header.get("endian")) == "big";
    if (bytes_of(head.type) > 1 && header.get("endian").empty() && lower(header.get("encoding")) == "raw") {
        reading.fail("endian is missing");
    }
    Axes axes;
    try {
        const ItkHeader itk = read_itk_header(ItkFormat::nrrd, reading.file);
        axes = nrrd_axes(sizes, itk, reading);
        head.volume.grid = itk.grid;
        if (const std::string space = lower(header.get("space"));
            space == "left-anterior-superior" || space == "las") {
            half_turn(head.volume.grid);
        }
        apply_units(header, head.volume.grid, reading);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        reading.fail(error.what());
    }
    head.volume.grid.dims = axes.dims;
    head.volume.channels = axes.channels;
    head.volume.slope = value_of(header, "rescale_slope", reading).value_or(1.0);
    head.volume.intercept = value_of(header, "rescale_intercept", reading).value_or(0.0);
    if (const auto unit = header.values.find("unit"); unit != header.values.end()) {
        head.volume.unit = unit->second;
    }
    head.volume.grid.shape = shape_of_keys(header.values, reading);
    const std::uint64_t due = head.bytes(reading);
    const std::optional<Payload> payload = axes.is_plain ? payload_of(header, due, reading) : std::nullopt;
    if (payload) {
        return read_voxels(head, open_payload(*payload, due, reading), reading);
    }
    require_plausible(head, reading);
    const std::vector<std::byte> voxels = read_itk_voxels(ItkFormat::nrrd, head, reading);
    head.big_endian = false;
    return read_voxels(head, read_from_memory(voxels, reading), reading);
}

}  // namespace viscera::io

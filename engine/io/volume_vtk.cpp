#include <algorithm>
#include <charconv>
#include <map>
#include <optional>

#include "engine/io/file_bytes.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_text.h"
#include "engine/io/vtk_data.h"
#include "engine/io/words.h"

namespace viscera::io {

namespace {

/// Widths as VTK has them on 64-bit Linux.
std::optional<FileScalar> legacy_type(std::string_view name) {
    static const std::map<std::string, FileScalar, std::less<>> types{
        {"unsigned_char", FileScalar::u8}, {"char", FileScalar::i8},
        {"signed_char", FileScalar::i8},   {"unsigned_short", FileScalar::u16},
        {"short", FileScalar::i16},        {"unsigned_int", FileScalar::u32},
        {"int", FileScalar::i32},          {"unsigned_long", FileScalar::u64},
        {"long", FileScalar::i64},         {"unsigned_long_long", FileScalar::u64},
        {"long_long", FileScalar::i64},    {"vtktypeuint64", FileScalar::u64},
        {"vtktypeint64", FileScalar::i64}, {"vtkidtype", FileScalar::i64},
        {"float", FileScalar::f32},        {"double", FileScalar::f64}};
    const auto found = types.find(lower(name));
    return found == types.end() ? std::nullopt : std::optional(found->second);
}

struct Array {
    FileScalar type = FileScalar::f32;
    std::uint64_t components = 1;
    std::uint64_t tuples = 0;
};

/// Walks through the keywords of the header up to the voxels.
class VtkHeader {
  public:
    VtkHeader(std::string_view text, const Reading& reading) : text_(text), rest_(text), reading_(reading) {
        if (!take_line(rest_).starts_with("# vtk DataFile")) {
            reading_.fail("does not begin with '# vtk DataFile'");
        }
        static_cast<void>(take_line(rest_));  // its title
        const std::string coding = lower(trim(take_line(rest_)));
        binary_ = coding == "binary";
        if (!binary_ && coding != "ascii") {
            reading_.fail("its third line is neither ASCII nor BINARY");
        }
        walk();
    }

    [[nodiscard]] const VolumeHead& head() const { return head_; }
    [[nodiscard]] bool is_binary() const { return binary_; }
    [[nodiscard]] std::size_t offset() const { return static_cast<std::size_t>(rest_.data() - text_.data()); }

  private:
    void walk() {
        while (!found_) {
            if (trim(rest_).empty()) {
                reading_.fail("is truncated: its header ends before the voxels");
            }
            std::string_view line = take_line(rest_);
            const std::string keyword = lower(take_word(line));
            if (keyword == "dataset") {
                if (const std::string kind = lower(trim(line)); kind != "structured_points") {
                    reading_.fail("its dataset is '" + printable(kind) + "', not STRUCTURED_POINTS");
                }
            } else if (keyword == "dimensions") {
                const std::vector<double> sizes = three(line, "DIMENSIONS");
                head_.volume.grid.dims = dims_of(sizes, "DIMENSIONS", reading_);
                dims_known_ = true;
            } else if (keyword == "spacing" || keyword == "aspect_ratio") {
                head_.volume.grid.spacing_mm = vector(three(line, "SPACING"));
            } else if (keyword == "origin") {
                head_.volume.grid.origin_mm = vector(three(line, "ORIGIN"));
            } else if (keyword == "point_data") {
                points_ = one_number(line, "POINT_DATA", reading_);
            } else if (keyword == "cell_data") {
                reading_.fail("has CELL_DATA before any values at points");
            } else if (keyword == "metadata") {
                while (!trim(rest_).empty() && !trim(take_line(rest_)).empty()) {
                }
            } else {
                attribute(keyword, line);
            }
        }
    }

    void attribute(const std::string& keyword, std::string_view line) {
        static_cast<void>(keyword == "field" ? take_word(line) : std::string_view{});
        if (keyword == "field") {
            field(static_cast<int>(whole_number(line, "FIELD", 0.0, 1e4, reading_)));
            return;
        }
        static_cast<void>(take_word(line));  // its name
        if (keyword == "scalars") {
            const Array array{known(take_word(line)), components(take_word(line)), 0};
            std::string_view next = rest_;
            if (std::string_view table = take_line(next); lower(take_word(table)) == "lookup_table") {
                rest_ = next;
            }
            found(array);
        } else if (keyword == "color_scalars") {
            if (!binary_) {
                reading_.fail("COLOR_SCALARS are read from BINARY files only");
            }
            found({FileScalar::u8, components(take_word(line)), 0});
        } else if (keyword == "vectors" || keyword == "normals") {
            found({known(take_word(line)), 3, 0});
        } else if (!keyword.empty()) {
            reading_.fail("keyword '" + printable(keyword) + "' is not read");
        }
    }

    /// Arrays of a FIELD: skipped before the points, the first with a tuple for each point taken after.
    void field(int arrays) {
        for (int i = 0; i < arrays && !found_; ++i) {
            std::string_view line;
            while (trim(line).empty() && !rest_.empty()) {
                line = take_line(rest_);
            }
            static_cast<void>(take_word(line));
            const std::uint64_t width = components(take_word(line));
            const auto tuples =
                static_cast<std::uint64_t>(whole_number(take_word(line), "FIELD", 0.0, 1e15, reading_));
            const std::string_view type = trim(line);
            if (dims_known_ && tuples == head_.volume.grid.voxel_count()) {
                found({known(type), width, tuples});
            } else {
                skip(type, width * tuples);
            }
        }
    }

    void skip(std::string_view type, std::uint64_t values) {
        if (binary_ && lower(type) != "string") {
            const std::uint64_t bytes = values * bytes_of(known(type));
            rest_.remove_prefix(std::min<std::uint64_t>(bytes, rest_.size()));
        } else {
            for (std::uint64_t i = 0; i < values && !rest_.empty(); ++i) {
                static_cast<void>(binary_ ? take_line(rest_) : take_word(rest_));
            }
        }
        static_cast<void>(take_line(rest_));
    }

    void found(const Array& array) {
        if (!dims_known_) {
            reading_.fail("DIMENSIONS are missing");
        }
        head_.type = array.type;
        head_.volume.channels = static_cast<int>(array.components);
        head_.big_endian = binary_;
        static_cast<void>(head_.bytes(reading_));
        if (points_ != static_cast<double>(head_.volume.grid.voxel_count())) {
            reading_.fail("POINT_DATA and DIMENSIONS do not agree");
        }
        found_ = true;
    }

    [[nodiscard]] FileScalar known(std::string_view name) const {
        const std::optional<FileScalar> type = legacy_type(name);
        if (!type) {
            reading_.fail("values of type '" + printable(name) + "' are not read");
        }
        return *type;
    }
    [[nodiscard]] std::uint64_t components(std::string_view word) const {
        return word.empty() ? 1
                            : static_cast<std::uint64_t>(
                                  whole_number(word, "number of components", 1.0, 1e6, reading_));
    }
    [[nodiscard]] std::vector<double> three(std::string_view line, std::string_view field) const {
        std::vector<double> numbers = numbers_of(line, field, reading_);
        if (numbers.size() != 3) {
            reading_.fail(std::string(field) + " needs 3 numbers");
        }
        return numbers;
    }
    [[nodiscard]] static glm::dvec3 vector(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

    std::string_view text_;
    std::string_view rest_;
    const Reading& reading_;
    VolumeHead head_;
    bool binary_ = false;
    bool dims_known_ = false;
    bool found_ = false;
    double points_ = 0.0;
};

Volume read_text(const VtkHeader& header, std::size_t count, const Reading& reading) {
    const std::string text = read_file(reading.file);
    const std::string_view voxels = std::string_view(text).substr(header.offset());
    if (voxels.size() / 2 + 1 < count) {
        reading.fail("is truncated or lies about its size: " + std::to_string(count) + " values do not fit");
    }
    require_memory(header.head(), count * (sizeof(double) + bytes_of(header.head().type)), reading);
    std::vector<double> numbers;
    numbers.reserve(count);
    for (std::string_view rest = voxels; numbers.size() < count;) {
        const std::string_view word = take_word(rest);
        const std::optional<double> number = to_number(word);
        if (!number) {
            reading.fail(word.empty() ? "is truncated: its voxels end too early"
                                      : "voxels: '" + printable(word) + "' is no number");
        }
        numbers.push_back(*number);
    }
    const std::vector<std::byte> bytes = encode(numbers, header.head().type, reading);
    return read_voxels(header.head(), read_from_memory(bytes, reading), reading);
}

}  // namespace

Volume read_legacy_vtk(const Reading& reading) {
    constexpr std::size_t most_header = std::size_t{1} << 20U;
    static_cast<void>(size_of(reading.file, reading));
    const std::string start = first_bytes(reading.file, most_header);
    const VtkHeader header(start, reading);
    const std::uint64_t due = header.head().bytes(reading);
    if (!header.is_binary()) {
        return read_text(header, due / bytes_of(header.head().type), reading);
    }
    return read_voxels(header.head(), open_payload({reading.file, header.offset()}, due, reading), reading);
}

}  // namespace viscera::io

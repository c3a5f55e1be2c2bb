#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/volume_axes.h"
#include "engine/io/volume_readers.h"
#include "engine/io/volume_text.h"

namespace viscera::io {

namespace {

using Json = nlohmann::json;

FileScalar sidecar_type(const std::string& name, const Reading& reading) {
    static const std::map<std::string, FileScalar, std::less<>> types{
        {"u8", FileScalar::u8},   {"i8", FileScalar::i8},   {"u16", FileScalar::u16},
        {"i16", FileScalar::i16}, {"u32", FileScalar::u32}, {"i32", FileScalar::i32},
        {"u64", FileScalar::u64}, {"i64", FileScalar::i64}, {"f32", FileScalar::f32},
        {"f64", FileScalar::f64}};
    const auto found = types.find(name);
    if (found == types.end()) {
        reading.fail("type: '" + printable(name) + "' is none of u8 i8 u16 i16 u32 i32 u64 i64 f32 f64");
    }
    return found->second;
}

/// Fields of the sidecar, each error naming its field.
class Sidecar {
  public:
    explicit Sidecar(const Reading& reading) : reading_(reading) {
        constexpr std::size_t most_bytes = std::size_t{1} << 20U;
        try {
            json_ = Json::parse(read_file(reading.file, most_bytes));
        } catch (const Json::exception& error) {
            reading.fail(std::string("is no JSON: ") + error.what());
        }
        if (!json_.is_object()) {
            reading.fail("is no JSON object");
        }
        static constexpr std::array<std::string_view, 13> known{
            "file",  "dims",      "type", "byte_order", "spacing_mm", "origin_mm", "direction",
            "slope", "intercept", "unit", "channels",   "offset",     "axes"};
        for (const auto& [key, value] : json_.items()) {
            if (std::ranges::find(known, key) == known.end()) {
                reading.fail("field '" + printable(key) + "' is unknown");
            }
        }
    }

    [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }

    [[nodiscard]] std::string text(const char* key, const char* otherwise = nullptr) const {
        if (!has(key) && otherwise != nullptr) {
            return otherwise;
        }
        if (!has(key) || !json_[key].is_string()) {
            reading_.fail(std::string(key) + " must be a text");
        }
        return json_[key].get<std::string>();
    }
    [[nodiscard]] double number(const char* key, double otherwise) const {
        return has(key) ? numbers(key, 1)[0] : otherwise;
    }
    [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count) const {
        std::vector<double> result;
        const Json value = has(key) ? json_[key] : Json();
        flatten(value, result, key);
        if (result.size() != count) {
            reading_.fail(std::string(key) + " must hold " + std::to_string(count) +
                          (count == 1 ? " number" : " numbers"));
        }
        return result;
    }
    [[nodiscard]] glm::dvec3 vector(const char* key, const glm::dvec3& otherwise) const {
        if (!has(key)) {
            return otherwise;
        }
        const std::vector<double> v = numbers(key, 3);
        return {v[0], v[1], v[2]};
    }
    [[nodiscard]] std::uint64_t whole(const char* key, double low, double high, double otherwise) const {
        const double value = number(key, otherwise);
        if (!(value >= low && value <= high) || value != std::floor(value)) {
            reading_.fail(std::string(key) + " is out of range");
        }
        return static_cast<std::uint64_t>(value);
    }

  private:
    void flatten(const Json& value, std::vector<double>& result, const char* key) const {
        if (value.is_number()) {
            result.push_back(value.get<double>());
        } else if (value.is_array()) {
            for (const Json& one : value) {
                flatten(one, result, key);
            }
        } else {
            reading_.fail(std::string(key) + (value.is_null() ? " is missing" : " must hold numbers"));
        }
    }

    const Reading& reading_;
    Json json_;
};

VolumeHead head_of(const Sidecar& sidecar, const Reading& reading) {
    VolumeHead head;
    Volume& volume = head.volume;
    volume.grid.dims = dims_of(sidecar.numbers("dims", 3), "dims", reading);
    volume.grid.spacing_mm = sidecar.vector("spacing_mm", glm::dvec3(1.0));
    volume.grid.origin_mm = sidecar.vector("origin_mm", glm::dvec3(0.0));
    if (sidecar.has("direction") && sidecar.has("axes")) {
        reading.fail("direction and axes are two words for one thing: give one of them");
    }
    if (sidecar.has("direction")) {
        // Rows as they are written: x, y, z of the world.
        const std::vector<double> d = sidecar.numbers("direction", 9);
        volume.grid.direction =
            glm::transpose(glm::dmat3(d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7], d[8]));
    } else if (const std::optional<glm::dmat3> axes = direction_of_axes(sidecar.text("axes", "LPS"))) {
        volume.grid.direction = *axes;
    } else {
        reading.fail("axes: '" + printable(sidecar.text("axes")) +
                     "' must be three letters, one each of L or R, P or A, S or I");
    }
    volume.slope = sidecar.number("slope", 1.0);
    volume.intercept = sidecar.number("intercept", 0.0);
    volume.unit = sidecar.text("unit", "");
    volume.channels = static_cast<int>(sidecar.whole("channels", 1.0, 4.0, 1.0));
    head.type = sidecar_type(sidecar.text("type"), reading);
    const std::string order = sidecar.text("byte_order", "little");
    if (order != "little" && order != "big") {
        reading.fail("byte_order: '" + printable(order) + "' is neither 'little' nor 'big'");
    }
    head.big_endian = order == "big";
    return head;
}

bool is_gzipped(const std::filesystem::path& file) {
    return first_bytes(file, 2) == "\x1f\x8b";
}

/// Raw voxels say nothing of themselves, so their number must be right to the byte.
Volume read_raw(const VolumeHead& head, const std::filesystem::path& file, std::uint64_t offset,
                const Reading& reading) {
    const std::uint64_t due = head.bytes(reading);
    const std::uint64_t size = size_of(file, reading);
    if (is_gzipped(file)) {
        if (offset > 0) {
            reading.fail("offset must be 0 for a gzipped file");
        }
        const ReadBytes read = open_payload({file, 0, Packing::zlib}, due, reading);
        return read_voxels(head, read, reading);
    }
    if (size > due && size - due != offset) {
        reading.fail("dims, type, channels and offset ask for " + std::to_string(due + offset) + " bytes, '" +
                     file.filename().string() + "' has " + std::to_string(size));
    }
    return read_voxels(head, open_payload({file, offset}, due, reading), reading);
}

/// Children of a plist's dict: the element after the key of that name.
pugi::xml_node plist_value(const pugi::xml_node& dict, std::string_view name) {
    for (const pugi::xml_node key : dict.children("key")) {
        if (key.text().get() == name) {
            return key.next_sibling();
        }
    }
    return {};
}

std::vector<double> plist_numbers(const pugi::xml_node& array, std::string_view field,
                                  const Reading& reading) {
    std::string text;
    for (const pugi::xml_node item : array.children()) {
        text += std::string(item.text().get()) + " ";
    }
    std::vector<double> numbers = numbers_of(text, field, reading);
    if (numbers.size() != 3) {
        reading.fail(std::string(field) + " needs 3 numbers");
    }
    return numbers;
}

}  // namespace

std::optional<glm::dmat3> direction_of_axes(std::string_view axes) {
    if (axes.size() != 3) {
        return std::nullopt;
    }
    glm::dmat3 direction(0.0);
    for (int column = 0; column < 3; ++column) {
        constexpr std::string_view positive = "LPS";
        constexpr std::string_view negative = "RAI";
        const char letter = axes[static_cast<std::size_t>(column)];
        const std::size_t up = positive.find(letter);
        const std::size_t down = negative.find(letter);
        if (up == std::string_view::npos && down == std::string_view::npos) {
            return std::nullopt;
        }
        const bool is_up = up != std::string_view::npos;
        direction[column][static_cast<int>(is_up ? up : down)] = is_up ? 1.0 : -1.0;
    }
    return glm::determinant(direction) == 0.0 ? std::nullopt : std::optional(direction);
}

Volume read_raw_sidecar(const Reading& reading) {
    const Sidecar sidecar(reading);
    const VolumeHead head = head_of(sidecar, reading);
    const std::uint64_t offset = sidecar.whole("offset", 0.0, 1e15, 0.0);
    return read_raw(head, reading.file.parent_path() / sidecar.text("file"), offset, reading);
}

Volume read_invesalius(const Reading& reading) {
    constexpr std::size_t most_bytes = std::size_t{16} << 20U;
    const std::string text = read_file(reading.file, most_bytes);
    pugi::xml_document document;
    if (const auto parsed = document.load_buffer(text.data(), text.size()); !parsed) {
        reading.fail(std::string(parsed.description()) + " at byte " + std::to_string(parsed.offset));
    }
    const pugi::xml_node dict = document.child("plist").child("dict");
    const pugi::xml_node matrix = plist_value(dict, "matrix");
    const std::vector<double> shape = plist_numbers(plist_value(matrix, "shape"), "shape", reading);
    const std::vector<double> spacing = plist_numbers(plist_value(dict, "spacing"), "spacing", reading);
    if (const std::string type = plist_value(matrix, "dtype").text().get(); type != "int16") {
        reading.fail("dtype: '" + printable(type) + "' is not int16");
    }
    VolumeHead head;
    head.type = FileScalar::i16;
    // Slowest axis first in the file.
    const std::array<double, 3> sizes{shape[2], shape[1], shape[0]};
    head.volume.grid.dims = dims_of(sizes, "shape", reading);
    head.volume.grid.spacing_mm = {spacing[0], spacing[1], spacing[2]};
    // InVesalius turns the rows of a slice over, and keeps no position.
    head.volume.grid.direction = *direction_of_axes("LAS");
    const std::string modality = plist_value(dict, "modality").text().get();
    head.volume.unit = modality == "CT" ? "HU" : "";
    std::filesystem::path file = reading.file.parent_path() / plist_value(matrix, "filename").text().get();
    if (!std::filesystem::is_regular_file(file)) {
        file += ".gz";
    }
    reading.log.info(reading.file.string() +
                     ": holds no orientation; i is taken to run to the patient's left, "
                     "j to the front, k to the head");
    return read_raw(head, file, 0, reading);
}

}  // namespace viscera::io

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/mesh_readers.h"
#include "engine/io/words.h"

namespace viscera::io {

namespace {

enum class Storage { text, little_endian, big_endian };

template <class T>
double load(const char* bytes, bool swap) {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes, sizeof(T));
    if (swap) {
        std::ranges::reverse(raw);
    }
    return static_cast<double>(std::bit_cast<T>(raw));
}

/// A scalar type of PLY: its two names, its bytes in a binary file, and how they become a number.
struct Type {
    std::string_view name;
    std::string_view alias;
    std::size_t bytes;
    double (*load)(const char*, bool);
};

constexpr std::array<Type, 8> types{{{"char", "int8", 1, load<std::int8_t>},
                                     {"uchar", "uint8", 1, load<std::uint8_t>},
                                     {"short", "int16", 2, load<std::int16_t>},
                                     {"ushort", "uint16", 2, load<std::uint16_t>},
                                     {"int", "int32", 4, load<std::int32_t>},
                                     {"uint", "uint32", 4, load<std::uint32_t>},
                                     {"float", "float32", 4, load<float>},
                                     {"double", "float64", 8, load<double>}}};

const Type& type_named(std::string_view name) {
    const auto* const found = std::ranges::find_if(
        types, [&](const Type& type) { return name == type.name || name == type.alias; });
    if (found == types.end()) {
        throw std::runtime_error("type '" + std::string(name.substr(0, 20)) + "' is unknown");
    }
    return *found;
}

struct Property {
    std::string name;
    const Type* type = nullptr;
    const Type* count_type = nullptr;  ///< none: one value; else a list with its length before it
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

struct PlyHeader {
    Storage storage = Storage::text;
    std::vector<PlyElement> elements;
};

Storage storage_named(std::string_view name) {
    if (name == "ascii") {
        return Storage::text;
    }
    if (name != "binary_little_endian" && name != "binary_big_endian") {
        throw std::runtime_error("format '" + std::string(name.substr(0, 30)) + "' is unknown");
    }
    return name == "binary_big_endian" ? Storage::big_endian : Storage::little_endian;
}

PlyElement parse_element(std::string_view line) {
    PlyElement element;
    element.name = take_word(line);
    const std::string_view count = take_word(line);
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (count.empty() || error != std::errc{} || end != count.data() + count.size()) {
        throw std::runtime_error("element '" + element.name + "' has no count");
    }
    return element;
}

Property parse_property(std::string_view line) {
    Property property;
    std::string_view type = take_word(line);
    if (type == "list") {
        property.count_type = &type_named(take_word(line));
        type = take_word(line);
    }
    property.type = &type_named(type);
    property.name = take_word(line);
    return property;
}

/// Takes the header off the front of `bytes`.
PlyHeader take_header(std::string_view& bytes) {
    PlyHeader header;
    std::string_view first = take_line(bytes);
    if (take_word(first) != "ply") {
        throw std::runtime_error("it does not begin with 'ply'");
    }
    while (true) {
        if (bytes.find('\n') == std::string_view::npos) {
            throw std::runtime_error("its header is cut off");
        }
        std::string_view line = take_line(bytes);
        const std::string_view word = take_word(line);
        if (word == "end_header") {
            return header;
        }
        if (word == "format") {
            header.storage = storage_named(take_word(line));
        } else if (word == "element") {
            header.elements.push_back(parse_element(line));
        } else if (word == "property" && !header.elements.empty()) {
            header.elements.back().properties.push_back(parse_property(line));
        } else if (!word.empty() && word != "comment" && word != "obj_info") {
            throw std::runtime_error("its header line '" + std::string(word.substr(0, 30)) +
                                     "' is not understood");
        }
    }
}

/// Takes numbers off the front of the body.
class Body {
  public:
    Body(std::string_view bytes, Storage storage) : bytes_(bytes), storage_(storage) {}

    double next(const Type& type) {
        if (storage_ == Storage::text) {
            return next_text();
        }
        if (bytes_.size() < type.bytes) {
            throw std::runtime_error("it is cut off");
        }
        const bool big_endian = storage_ == Storage::big_endian;
        const double value =
            type.load(bytes_.data(), big_endian != (std::endian::native == std::endian::big));
        bytes_.remove_prefix(type.bytes);
        return value;
    }

    /// A count of values that follow: never more than there are bytes left.
    std::size_t next_count(const Type& type) {
        const double count = next(type);
        if (!(count >= 0.0 && count <= static_cast<double>(bytes_.size()))) {
            throw std::runtime_error("a list is longer than the file");
        }
        return static_cast<std::size_t>(count);
    }

    /// Whether so many items of these properties can follow. Found out before memory is asked for: a lying
    /// count could ask for more than there is. An empty list is its length alone, a number in text a digit
    /// and a space.
    [[nodiscard]] bool may_hold(std::uint64_t items, const std::vector<Property>& properties) const {
        std::size_t least = 0;
        for (const Property& property : properties) {
            const Type& first = *(property.count_type != nullptr ? property.count_type : property.type);
            least += storage_ == Storage::text ? 2 : first.bytes;
        }
        const std::size_t end = storage_ == Storage::text ? 1 : 0;  // behind the last number
        return least == 0 || items <= (bytes_.size() + end) / least;
    }

  private:
    double next_text() {
        const std::string_view word = take_word(bytes_);
        const auto value = to_number(word);
        if (!value) {
            throw std::runtime_error(word.empty() ? "it is cut off"
                                                  : "'" + std::string(word.substr(0, 20)) + "' is no number");
        }
        return *value;
    }

    std::string_view bytes_;
    Storage storage_;
};

/// Where a vertex property goes.
using Store = void (*)(MeshData&, std::size_t vertex, float value);

Store store_of(std::string_view name) {
    struct Target {
        std::string_view name;
        Store store;
    };
    static constexpr std::array<Target, 12> targets{
        {{"x", [](MeshData& m, std::size_t v, float value) { m.positions[v].x = value; }},
         {"y", [](MeshData& m, std::size_t v, float value) { m.positions[v].y = value; }},
         {"z", [](MeshData& m, std::size_t v, float value) { m.positions[v].z = value; }},
         {"nx", [](MeshData& m, std::size_t v, float value) { m.normals[v].x = value; }},
         {"ny", [](MeshData& m, std::size_t v, float value) { m.normals[v].y = value; }},
         {"nz", [](MeshData& m, std::size_t v, float value) { m.normals[v].z = value; }},
         {"s", [](MeshData& m, std::size_t v, float value) { m.uvs[v].x = value; }},
         {"t", [](MeshData& m, std::size_t v, float value) { m.uvs[v].y = value; }},
         {"u", [](MeshData& m, std::size_t v, float value) { m.uvs[v].x = value; }},
         {"v", [](MeshData& m, std::size_t v, float value) { m.uvs[v].y = value; }},
         {"texture_u", [](MeshData& m, std::size_t v, float value) { m.uvs[v].x = value; }},
         {"texture_v", [](MeshData& m, std::size_t v, float value) { m.uvs[v].y = value; }}}};
    const auto* const found = std::ranges::find(targets, name, &Target::name);
    return found == targets.end() ? nullptr : found->store;
}

void read_vertices(const PlyElement& element, Body& body, MeshData& mesh) {
    if (element.properties.empty() || !body.may_hold(element.count, element.properties)) {
        throw std::runtime_error("it promises more vertices than it holds");
    }
    mesh.positions.assign(element.count, glm::vec3(0.0F));
    std::vector<Store> stores;
    std::vector<std::size_t> scalar_of;
    for (const Property& property : element.properties) {
        const Store store = property.count_type == nullptr ? store_of(property.name) : nullptr;
        const bool is_normal = store != nullptr && property.name.starts_with('n');
        const bool is_position = property.name == "x" || property.name == "y" || property.name == "z";
        if (is_normal) {
            mesh.normals.resize(element.count);
        } else if (store != nullptr && !is_position) {
            mesh.uvs.resize(element.count);
        }
        stores.push_back(store);
        scalar_of.push_back(mesh.scalars.size());
        if (store == nullptr && property.count_type == nullptr) {
            mesh.scalars.push_back({property.name, std::vector<float>(element.count)});
        }
    }
    for (std::size_t v = 0; v < element.count; ++v) {
        for (std::size_t p = 0; p < stores.size(); ++p) {
            const Property& property = element.properties[p];
            if (property.count_type != nullptr) {
                for (std::size_t i = body.next_count(*property.count_type); i > 0; --i) {
                    static_cast<void>(body.next(*property.type));
                }
                continue;
            }
            const auto value = static_cast<float>(body.next(*property.type));
            if (stores[p] != nullptr) {
                stores[p](mesh, v, value);
            } else {
                mesh.scalars[scalar_of[p]].values[v] = value;
            }
        }
    }
}

/// Reads an element other than vertices; lists of corners become triangles.
void read_element(const PlyElement& element, Body& body, MeshData& mesh) {
    constexpr std::uint32_t out_of_range = std::numeric_limits<std::uint32_t>::max();
    if (!body.may_hold(element.count, element.properties)) {
        throw std::runtime_error("it promises more of '" + element.name + "' than it holds");
    }
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 0; !element.properties.empty() && i < element.count; ++i) {
        for (const Property& property : element.properties) {
            const bool is_list = property.count_type != nullptr;
            const std::size_t count = is_list ? body.next_count(*property.count_type) : 1;
            corners.clear();
            for (std::size_t k = 0; k < count; ++k) {
                const double value = body.next(*property.type);
                const bool fits = value >= 0.0 && value < static_cast<double>(out_of_range);
                corners.push_back(fits ? static_cast<std::uint32_t>(value) : out_of_range);
            }
            if (is_list && (property.name == "vertex_indices" || property.name == "vertex_index")) {
                append_fan(
                    count, [&](std::size_t k) { return corners[k]; }, mesh.indices);
            }
        }
    }
}

}  // namespace

std::vector<RawMesh> read_ply(const std::filesystem::path& file, Log&) {
    const std::string bytes = read_file(file);
    try {
        std::string_view rest = bytes;
        const PlyHeader header = take_header(rest);
        Body body(rest, header.storage);
        RawMesh raw;
        raw.mesh.name = file.stem().string();
        for (const PlyElement& element : header.elements) {
            if (element.name == "vertex" && raw.mesh.positions.empty()) {
                read_vertices(element, body, raw.mesh);
            } else {
                read_element(element, body, raw.mesh);
            }
        }
        return {std::move(raw)};
    } catch (const std::runtime_error& error) {
        throw Error(ErrorCode::file, file.string(), std::string("is no readable PLY file: ") + error.what());
    }
}

}  // namespace viscera::io

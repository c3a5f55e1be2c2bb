#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/io/gltf_file.h"

namespace viscera::io {

namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(const std::string& pointer, const std::string& message) {
    throw std::runtime_error(pointer + ": " + message);
}

/// A list of objects, or nothing where the key is absent.
const Json& list_of(const Json& document, const char* key) {
    static const Json none = Json::array();
    const auto found = document.find(key);
    if (found == document.end()) {
        return none;
    }
    if (!found->is_array()) {
        fail(std::string("/") + key, "must be a list");
    }
    for (std::size_t i = 0; i < found->size(); ++i) {
        if (!(*found)[i].is_object()) {
            fail(std::string("/") + key + "/" + std::to_string(i), "must be an object");
        }
    }
    return *found;
}

std::optional<std::uint64_t> whole_number_at(const Json& object, const char* key,
                                             const std::string& pointer) {
    constexpr std::uint64_t most = std::uint64_t{1} << 32U;
    const auto found = object.find(key);
    if (found == object.end()) {
        return std::nullopt;
    }
    if (!found->is_number_unsigned() || found->get<std::uint64_t>() >= most) {
        fail(pointer + "/" + key, "must be a whole number, 0 or above");
    }
    return found->get<std::uint64_t>();
}

std::uint64_t needed_number(const Json& object, const char* key, const std::string& pointer) {
    const auto number = whole_number_at(object, key, pointer);
    if (!number) {
        fail(pointer + "/" + key, "is missing");
    }
    return *number;
}

std::size_t check_index(std::uint64_t index, std::size_t size, const std::string& pointer, const char* what) {
    if (index >= size) {
        fail(pointer, "there is no " + std::string(what) + " " + std::to_string(index));
    }
    return index;
}

std::size_t component_bytes(std::uint64_t type, const std::string& pointer) {
    switch (type) {
        case 5120:  // byte
        case 5121:  // unsigned byte
            return 1;
        case 5122:  // short
        case 5123:  // unsigned short
            return 2;
        case 5125:  // unsigned int
        case 5126:  // float
            return 4;
        default:
            fail(pointer, "component type " + std::to_string(type) + " is unknown");
    }
}

std::size_t component_count(const Json& accessor, const std::string& pointer) {
    const auto found = accessor.find("type");
    const std::string type = found != accessor.end() && found->is_string() ? found->get<std::string>() : "";
    constexpr std::array<std::pair<std::string_view, std::size_t>, 7> types{
        {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
    for (const auto& [name, count] : types) {
        if (type == name) {
            return count;
        }
    }
    fail(pointer + "/type", "'" + type.substr(0, 20) + "' is unknown");
}

/// What is known of an accessor once it has been checked.
struct Accessor {
    std::uint64_t count = 0;
    std::uint64_t component_type = 0;
    std::size_t components = 0;
};

class Checker {
  public:
    Checker(const Json& document, const std::vector<std::size_t>& buffer_bytes)
        : document_(document), buffer_bytes_(buffer_bytes) {}

    void run() {
        check_views();
        check_accessors();
        check_meshes();
        check_nodes();
        check_scenes();
    }

  private:
    void check_views() {
        const Json& views = list_of(document_, "bufferViews");
        for (std::size_t i = 0; i < views.size(); ++i) {
            const std::string pointer = "/bufferViews/" + std::to_string(i);
            const std::size_t buffer = check_index(needed_number(views[i], "buffer", pointer),
                                                   buffer_bytes_.size(), pointer + "/buffer", "buffer");
            const std::uint64_t offset = whole_number_at(views[i], "byteOffset", pointer).value_or(0);
            const std::uint64_t length = needed_number(views[i], "byteLength", pointer);
            if (length == 0 || offset + length > buffer_bytes_[buffer]) {
                fail(pointer, "reaches beyond its buffer");
            }
            const auto stride = whole_number_at(views[i], "byteStride", pointer);
            if (stride && (*stride < 4 || *stride > 252 || *stride % 4 != 0)) {
                fail(pointer + "/byteStride", "must be a multiple of 4 from 4 to 252");
            }
            view_bytes_.push_back(length);
        }
    }

    /// `count` elements of `bytes` each must fit into the view.
    void check_fit(const Json& object, std::uint64_t count, std::uint64_t bytes, const std::string& pointer) {
        const std::size_t view = check_index(needed_number(object, "bufferView", pointer), view_bytes_.size(),
                                             pointer + "/bufferView", "buffer view");
        const std::uint64_t offset = whole_number_at(object, "byteOffset", pointer).value_or(0);
        const auto stride =
            whole_number_at(document_["bufferViews"][view], "byteStride", pointer).value_or(bytes);
        if (stride < bytes) {
            fail(pointer, "its elements are longer than the byte stride");
        }
        if (count > 0 && offset + stride * (count - 1) + bytes > view_bytes_[view]) {
            fail(pointer, "reaches beyond its buffer view");
        }
    }

    void check_sparse(const Json& accessor, const Accessor& known, std::uint64_t bytes,
                      const std::string& pointer) {
        const Json& sparse = accessor["sparse"];
        if (!sparse.is_object() || !sparse.contains("indices") || !sparse["indices"].is_object() ||
            !sparse.contains("values") || !sparse["values"].is_object()) {
            fail(pointer, "must have indices and values");
        }
        const std::uint64_t count = needed_number(sparse, "count", pointer);
        if (count == 0 || count > known.count) {
            fail(pointer + "/count", "must be from 1 to the accessor's count");
        }
        const Json& indices = sparse["indices"];
        const std::string where = pointer + "/indices";
        const std::uint64_t type = needed_number(indices, "componentType", where);
        if (type != 5121 && type != 5123 && type != 5125) {
            fail(where + "/componentType", "must be an unsigned integer type");
        }
        check_fit(indices, count, component_bytes(type, where), where);
        check_fit(sparse["values"], count, bytes, pointer + "/values");
    }

    void check_accessors() {
        // Without a view an accessor is all zeros: no bytes bound its count, so a limit does.
        constexpr std::uint64_t most_without_view = std::uint64_t{1} << 24U;
        const Json& accessors = list_of(document_, "accessors");
        for (std::size_t i = 0; i < accessors.size(); ++i) {
            const std::string pointer = "/accessors/" + std::to_string(i);
            Accessor known;
            known.count = needed_number(accessors[i], "count", pointer);
            known.component_type = needed_number(accessors[i], "componentType", pointer);
            known.components = component_count(accessors[i], pointer);
            const std::uint64_t bytes =
                known.components * component_bytes(known.component_type, pointer + "/componentType");
            if (accessors[i].contains("bufferView")) {
                check_fit(accessors[i], known.count, bytes, pointer);
            } else if (known.count > most_without_view) {
                fail(pointer + "/count", "is too large for an accessor without a buffer view");
            }
            if (accessors[i].contains("sparse")) {
                check_sparse(accessors[i], known, bytes, pointer + "/sparse");
            }
            if (const auto flag = accessors[i].find("normalized");
                flag != accessors[i].end() && !flag->is_boolean()) {
                fail(pointer + "/normalized", "must be true or false");
            }
            accessors_.push_back(known);
        }
    }

    void check_primitive(const Json& primitive, const std::string& pointer) {
        if (!primitive.is_object() || !primitive.contains("attributes") ||
            !primitive["attributes"].is_object()) {
            fail(pointer + "/attributes", "must be an object");
        }
        if (whole_number_at(primitive, "mode", pointer).value_or(4) > 6) {
            fail(pointer + "/mode", "must be from 0 to 6");
        }
        const Json& attributes = primitive["attributes"];
        std::optional<std::uint64_t> vertices;
        for (const auto& [name, value] : attributes.items()) {
            const std::string where = pointer + "/attributes/" + name;
            const std::size_t index =
                check_index(needed_number(attributes, name.c_str(), pointer + "/attributes"),
                            accessors_.size(), where, "accessor");
            const Accessor& known = accessors_[index];
            if (vertices && *vertices != known.count) {
                fail(where, "has another number of elements than the other attributes");
            }
            vertices = known.count;
            const std::size_t components = name == "POSITION" || name == "NORMAL" ? 3
                                           : name == "TEXCOORD_0"                 ? 2
                                                                                  : known.components;
            if (components != known.components) {
                fail(where, "must have " + std::to_string(components) + " components");
            }
        }
        if (primitive.contains("indices")) {
            const std::size_t index = check_index(needed_number(primitive, "indices", pointer),
                                                  accessors_.size(), pointer + "/indices", "accessor");
            const std::uint64_t type = accessors_[index].component_type;
            if (accessors_[index].components != 1 || (type != 5121 && type != 5123 && type != 5125)) {
                fail(pointer + "/indices", "must be unsigned integers");
            }
        }
    }

    void check_meshes() {
        const Json& meshes = list_of(document_, "meshes");
        for (std::size_t m = 0; m < meshes.size(); ++m) {
            const Json& primitives = list_of(meshes[m], "primitives");
            for (std::size_t p = 0; p < primitives.size(); ++p) {
                check_primitive(primitives[p],
                                "/meshes/" + std::to_string(m) + "/primitives/" + std::to_string(p));
            }
        }
    }

    static void check_numbers(const Json& node, const char* key, std::size_t size,
                              const std::string& pointer) {
        const auto found = node.find(key);
        if (found == node.end()) {
            return;
        }
        bool good = found->is_array() && found->size() == size;
        for (std::size_t i = 0; good && i < size; ++i) {
            good = (*found)[i].is_number() && std::isfinite((*found)[i].get<double>());
        }
        if (!good) {
            fail(pointer + "/" + key, "must be " + std::to_string(size) + " numbers");
        }
    }

    void check_nodes() {
        const Json& nodes = list_of(document_, "nodes");
        const std::size_t meshes = list_of(document_, "meshes").size();
        constexpr std::size_t none = static_cast<std::size_t>(-1);
        std::vector<std::size_t> parent(nodes.size(), none);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const std::string pointer = "/nodes/" + std::to_string(i);
            check_numbers(nodes[i], "matrix", 16, pointer);
            check_numbers(nodes[i], "translation", 3, pointer);
            check_numbers(nodes[i], "rotation", 4, pointer);
            check_numbers(nodes[i], "scale", 3, pointer);
            if (const auto mesh = whole_number_at(nodes[i], "mesh", pointer)) {
                check_index(*mesh, meshes, pointer + "/mesh", "mesh");
            }
            for (const std::size_t child : index_list(nodes[i], "children", nodes.size(), pointer)) {
                if (parent[child] != none) {
                    fail(pointer + "/children", "node " + std::to_string(child) + " has two parents");
                }
                parent[child] = i;
            }
        }
        check_cycles(parent, none);
    }

    /// With one parent each, walking up either ends or comes back to where it began.
    static void check_cycles(const std::vector<std::size_t>& parent, std::size_t none) {
        std::vector<std::size_t> seen_from(parent.size(), none);
        for (std::size_t start = 0; start < parent.size(); ++start) {
            for (std::size_t i = start; i != none && seen_from[i] != start; i = parent[i]) {
                if (seen_from[i] != none) {
                    break;  // an earlier walk went on from here to its end
                }
                seen_from[i] = start;
                if (parent[i] != none && seen_from[parent[i]] == start) {
                    fail("/nodes/" + std::to_string(i), "is its own ancestor");
                }
            }
        }
    }

    static std::vector<std::size_t> index_list(const Json& object, const char* key, std::size_t size,
                                               const std::string& pointer) {
        std::vector<std::size_t> indices;
        const auto found = object.find(key);
        if (found == object.end()) {
            return indices;
        }
        const std::string where = pointer + "/" + key;
        if (!found->is_array()) {
            fail(where, "must be a list");
        }
        for (const Json& item : *found) {
            if (!item.is_number_unsigned()) {
                fail(where, "must hold whole numbers");
            }
            indices.push_back(check_index(item.get<std::uint64_t>(), size, where, "node"));
        }
        return indices;
    }

    void check_scenes() {
        const Json& scenes = list_of(document_, "scenes");
        const std::size_t nodes = list_of(document_, "nodes").size();
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            static_cast<void>(index_list(scenes[i], "nodes", nodes, "/scenes/" + std::to_string(i)));
        }
        if (const auto scene = whole_number_at(document_, "scene", "")) {
            check_index(*scene, scenes.size(), "/scene", "scene");
        }
    }

    const Json& document_;
    const std::vector<std::size_t>& buffer_bytes_;
    std::vector<std::uint64_t> view_bytes_;
    std::vector<Accessor> accessors_;
};

}  // namespace

void check_gltf(const Json& document, const std::vector<std::size_t>& buffer_bytes) {
    Checker(document, buffer_bytes).run();
}

}  // namespace viscera::io

#include "engine/io/gltf_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/vtk_data.h"

namespace viscera::io {

namespace {

using Json = nlohmann::json;

struct Container {
    std::string json;
    std::string binary;  ///< of a .glb; empty without
};

std::uint32_t word_at(const std::string& bytes, std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8U * i);
    }
    return value;
}

/// glTF 2.0, section 4.4: header of 12 bytes, then chunks of length, type and data.
Container open_container(std::string bytes) {
    constexpr std::uint32_t json_chunk = 0x4E4F534A;
    constexpr std::uint32_t binary_chunk = 0x004E4942;
    if (!bytes.starts_with("glTF")) {
        return {std::move(bytes), {}};
    }
    if (bytes.size() < 20 || word_at(bytes, 4) != 2 || word_at(bytes, 8) != bytes.size()) {
        throw std::runtime_error(
            "its header is of another version than 2 or of another length than the file");
    }
    Container container;
    std::size_t at = 12;
    while (at + 8 <= bytes.size()) {
        const std::size_t length = word_at(bytes, at);
        const std::uint32_t type = word_at(bytes, at + 4);
        if (length > bytes.size() - at - 8) {
            throw std::runtime_error("a chunk is cut off");
        }
        if (type == json_chunk && container.json.empty()) {
            container.json = bytes.substr(at + 8, length);
        } else if (type == binary_chunk && container.binary.empty()) {
            container.binary = bytes.substr(at + 8, length);
        }
        at += 8 + length;
    }
    return container;
}

Json parse(const std::string& text) {
    constexpr int deepest = 64;
    const auto guard = [](int depth, Json::parse_event_t, Json&) {
        if (depth > deepest) {
            throw std::runtime_error("its JSON is nested too deeply");
        }
        return true;
    };
    Json document = Json::parse(text, guard);
    if (!document.is_object()) {
        throw std::runtime_error("its JSON is no object");
    }
    return document;
}

std::string percent_decode(const std::string& text) {
    std::string decoded;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto digit = [&](std::size_t k) {
            constexpr std::string_view digits = "0123456789abcdef";
            const char c = k < text.size() ? static_cast<char>(text[k] | 0x20) : ' ';
            return digits.find(c);
        };
        if (text[i] == '%' && digit(i + 1) != std::string::npos && digit(i + 2) != std::string::npos) {
            decoded.push_back(static_cast<char>(digit(i + 1) * 16 + digit(i + 2)));
            i += 2;
        } else {
            decoded.push_back(text[i]);
        }
    }
    return decoded;
}

/// Bytes that a URI stands for. Only data URIs and files inside the glTF's own folder are followed.
std::string resolve(const std::string& uri, const std::filesystem::path& file) {
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(',');
        if (comma == std::string::npos || !std::string_view(uri).substr(0, comma).ends_with(";base64")) {
            throw std::runtime_error("is a data URI of another kind than base64");
        }
        return decode_base64(std::string_view(uri).substr(comma + 1));
    }
    const std::string decoded = percent_decode(uri);
    const std::filesystem::path relative(decoded);
    const std::filesystem::path folder =
        std::filesystem::weakly_canonical(std::filesystem::absolute(file)).parent_path();
    const std::filesystem::path target = std::filesystem::weakly_canonical(folder / relative);
    const std::filesystem::path inside = target.lexically_relative(folder);
    if (decoded.empty() || decoded.find('\0') != std::string::npos ||
        decoded.find(':') != std::string::npos || relative.is_absolute() || inside.empty() ||
        *inside.begin() == "..") {
        throw std::runtime_error("'" + decoded.substr(0, 80) + "' leaves the folder of the file");
    }
    return read_file(target);
}

std::vector<std::string> load_buffers(Json& document, std::string binary, const std::filesystem::path& file) {
    std::vector<std::string> buffers;
    const auto found = document.find("buffers");
    if (found == document.end()) {
        return buffers;
    }
    if (!found->is_array()) {
        throw std::runtime_error("/buffers: must be a list");
    }
    constexpr std::uint64_t most_bytes = std::uint64_t{4} << 30U;
    std::uint64_t total = 0;
    for (std::size_t i = 0; i < found->size(); ++i) {
        Json& buffer = (*found)[i];
        const std::string pointer = "/buffers/" + std::to_string(i);
        if (!buffer.is_object() || !buffer.value("byteLength", Json()).is_number_unsigned()) {
            throw std::runtime_error(pointer + "/byteLength: must be a whole number");
        }
        const auto length = buffer["byteLength"].get<std::uint64_t>();
        std::string bytes;
        if (const auto uri = buffer.find("uri"); uri == buffer.end()) {
            bytes = std::exchange(binary, {});  // of the first alone
        } else if (!uri->is_string()) {
            throw std::runtime_error(pointer + "/uri: must be text");
        } else {
            try {
                bytes = resolve(uri->get<std::string>(), file);
            } catch (const std::exception& error) {
                throw std::runtime_error(pointer + "/uri: " + error.what());
            }
        }
        if (length == 0 || length > bytes.size()) {
            throw std::runtime_error(pointer + "/byteLength: " + std::to_string(length) + " bytes, but " +
                                     std::to_string(bytes.size()) + " are there");
        }
        total += length;
        if (total > most_bytes) {
            throw std::runtime_error(pointer + ": all buffers together are too large");
        }
        bytes.resize(length);
        buffers.push_back(std::move(bytes));
        buffer = {{"byteLength", length}, {"uri", std::to_string(i)}};
    }
    return buffers;
}

/// Refuses what would change geometry in a way that is not done here.
void check_extensions(const Json& document) {
    for (const Json& name : document.value("extensionsRequired", Json::array())) {
        const std::string text = name.is_string() ? name.get<std::string>() : name.dump();
        const bool harmless = text == "KHR_mesh_quantization" || text == "KHR_texture_transform" ||
                              text == "KHR_lights_punctual" || text.starts_with("KHR_materials_") ||
                              text == "EXT_texture_webp" || text == "KHR_texture_basisu";
        if (!harmless) {
            throw std::runtime_error("/extensionsRequired: '" + text + "' is not supported");
        }
    }
}

Json geometry_of(const Json& document) {
    constexpr std::array<const char*, 7> kept{"scene",     "scenes",      "nodes",  "meshes",
                                              "accessors", "bufferViews", "buffers"};
    Json geometry = {{"asset", {{"version", "2.0"}}}};
    for (const char* key : kept) {
        if (const auto found = document.find(key); found != document.end()) {
            geometry[key] = *found;
        }
    }
    return geometry;
}

/// How often `key` stands in the objects of a list; what is no list of objects is refused elsewhere.
std::size_t count_key(const Json& list, const char* key) {
    return static_cast<std::size_t>(std::ranges::count_if(
        list, [&](const Json& item) { return item.is_object() && item.contains(key); }));
}

std::size_t count_poses(const Json& document) {
    std::size_t count = count_key(document.value("nodes", Json::array()), "skin");
    for (const Json& mesh : document.value("meshes", Json::array())) {
        if (mesh.is_object()) {
            count += count_key(mesh.value("primitives", Json::array()), "targets");
        }
    }
    return count;
}

/// Extras and extensions are of no use here and may be nested as deep as their author liked.
void strip_extras(Json& value) {
    if (value.is_object()) {
        value.erase("extras");
        value.erase("extensions");
        value.erase("targets");
        value.erase("weights");
    }
    if (value.is_structured()) {
        for (Json& child : value) {
            strip_extras(child);
        }
    }
}

}  // namespace

GltfFile read_gltf_file(const std::filesystem::path& file) {
    std::string bytes = read_file(file);
    try {
        Container container = open_container(std::move(bytes));
        const Json document = parse(container.json);
        const std::string version = document.value(Json::json_pointer("/asset/version"), std::string());
        if (!version.starts_with("2.")) {
            throw std::runtime_error("/asset/version: '" + version.substr(0, 20) + "', but 2.x is read");
        }
        check_extensions(document);
        GltfFile gltf{geometry_of(document), {}, count_poses(document)};
        strip_extras(gltf.document);
        gltf.buffers = load_buffers(gltf.document, std::move(container.binary), file);
        std::vector<std::size_t> sizes;
        for (const std::string& buffer : gltf.buffers) {
            sizes.push_back(buffer.size());
        }
        check_gltf(gltf.document, sizes);
        return gltf;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw Error(ErrorCode::file, file.string(), std::string("is no readable glTF file: ") + error.what());
    }
}

}  // namespace viscera::io

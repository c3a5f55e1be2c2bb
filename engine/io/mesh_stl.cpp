#include <bit>
#include <cstring>
#include <stdexcept>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/mesh_readers.h"
#include "engine/io/words.h"

// STL, OBJ and PLY are read here since assimp 5.2 hangs or crashes on damaged files of these formats.

namespace viscera::io {

namespace {

constexpr std::size_t header_bytes = 84;
constexpr std::size_t triangle_bytes = 50;

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8U * i);
    }
    return value;
}

/// Binary files may begin with "solid" too: the size tells.
bool is_binary(std::string_view bytes) {
    return bytes.size() >= header_bytes &&
           bytes.size() - header_bytes == triangle_bytes * std::size_t{word_at(bytes, header_bytes - 4)};
}

/// The stored normals, one per triangle, are left alone: the winding says the same.
std::vector<glm::vec3> read_binary(std::string_view bytes) {
    std::vector<glm::vec3> corners;
    corners.reserve((bytes.size() - header_bytes) / triangle_bytes * 3);
    for (std::size_t at = header_bytes; at < bytes.size(); at += triangle_bytes) {
        for (std::size_t k = 1; k <= 3; ++k) {
            const auto value = [&](std::size_t c) {
                return std::bit_cast<float>(word_at(bytes, at + 12 * k + 4 * c));
            };
            corners.emplace_back(value(0), value(1), value(2));
        }
    }
    return corners;
}

std::vector<glm::vec3> read_text(std::string_view bytes) {
    if (take_word(bytes) != "solid") {
        throw std::runtime_error("it is neither text nor of the size that its header says");
    }
    static_cast<void>(take_line(bytes));
    std::vector<glm::vec3> corners;
    std::string_view word = take_word(bytes);
    for (; !word.empty() && word != "endsolid"; word = take_word(bytes)) {
        if (word == "endfacet" && corners.size() % 3 != 0) {
            throw std::runtime_error("a facet has not three vertices");
        }
        if (word != "vertex") {
            continue;
        }
        glm::vec3 corner(0.0F);
        for (int c = 0; c < 3; ++c) {
            const std::string_view text = take_word(bytes);
            const auto value = to_number(text);
            if (!value) {
                throw std::runtime_error("'" + std::string(text.substr(0, 20)) + "' is no number");
            }
            corner[c] = static_cast<float>(*value);
        }
        corners.push_back(corner);
    }
    if (word.empty()) {
        throw std::runtime_error("it is cut off");
    }
    return corners;
}

}  // namespace

std::vector<RawMesh> read_stl(const std::filesystem::path& file, Log&) {
    const std::string bytes = read_file(file);
    RawMesh raw;
    raw.mesh.name = file.stem().string();
    raw.weld = true;
    try {
        raw.mesh.positions = is_binary(bytes) ? read_binary(bytes) : read_text(bytes);
    } catch (const std::runtime_error& error) {
        throw Error(ErrorCode::file, file.string(), std::string("is no readable STL file: ") + error.what());
    }
    raw.mesh.indices.resize(raw.mesh.positions.size() / 3 * 3);
    for (std::size_t i = 0; i < raw.mesh.indices.size(); ++i) {
        raw.mesh.indices[i] = static_cast<std::uint32_t>(i);
    }
    return {std::move(raw)};
}

}  // namespace viscera::io

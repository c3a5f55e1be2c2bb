#include <bit>
#include <numeric>
#include <stdexcept>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/mesh_readers.h"
#include "engine/io/words.h"

// STL, OBJ and PLY are read here since assimp 5.2 hangs or crashes on damaged files of these formats.

namespace viscera::io {

namespace {

constexpr std::size_t stl_header_bytes = 84;
constexpr std::size_t triangle_bytes = 50;

std::uint32_t stl_word(std::string_view bytes, std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8U * i);
    }
    return value;
}

/// Binary files may begin with "solid" too: the size tells.
bool is_binary(std::string_view bytes) {
    return bytes.size() >= stl_header_bytes &&
           bytes.size() - stl_header_bytes ==
               triangle_bytes * std::size_t{stl_word(bytes, stl_header_bytes - 4)};
}

/// The stored normals, one per triangle, are left alone: the winding says the same.
std::vector<glm::vec3> read_binary(std::string_view bytes) {
    std::vector<glm::vec3> corners;
    corners.reserve((bytes.size() - stl_header_bytes) / triangle_bytes * 3);
    for (std::size_t at = stl_header_bytes; at < bytes.size(); at += triangle_bytes) {
        for (std::size_t k = 1; k <= 3; ++k) {
            const auto value = [&](std::size_t c) {
                return std::bit_cast<float>(stl_word(bytes, at + 12 * k + 4 * c));
            };
            corners.emplace_back(value(0), value(1), value(2));
        }
    }
    return corners;
}

/// One solid of a text file, from behind the word "solid" to its end; the rest stays in `bytes`.
RawMesh read_solid(std::string_view& bytes) {
    RawMesh solid;
    std::string_view line = take_line(bytes);
    solid.mesh.name = take_word(line);
    std::vector<glm::vec3>& corners = solid.mesh.positions;
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
    static_cast<void>(take_line(bytes));  // the name again
    return solid;
}

/// Every solid of a text file: programs write one for each part of a vessel.
std::vector<RawMesh> read_text(std::string_view bytes) {
    std::vector<RawMesh> solids;
    std::string_view word = take_word(bytes);
    if (word != "solid") {
        throw std::runtime_error("it is neither text nor of the size that its header says");
    }
    for (; word == "solid"; word = take_word(bytes)) {
        solids.push_back(read_solid(bytes));
    }
    if (!word.empty()) {
        throw std::runtime_error("'" + std::string(word.substr(0, 20)) + "' follows a solid's end");
    }
    return solids;
}

}  // namespace

std::vector<RawMesh> read_stl(const std::filesystem::path& file, Log&) {
    const std::string bytes = read_file(file);
    std::vector<RawMesh> solids;
    try {
        if (is_binary(bytes)) {
            solids.emplace_back().mesh.positions = read_binary(bytes);
        } else {
            solids = read_text(bytes);
        }
    } catch (const std::runtime_error& error) {
        throw Error(ErrorCode::file, file.string(), std::string("is no readable STL file: ") + error.what());
    }
    for (RawMesh& solid : solids) {
        MeshData& mesh = solid.mesh;
        if (solids.size() == 1 || mesh.name.empty()) {
            mesh.name = file.stem().string();
        }
        solid.weld = true;
        mesh.indices.resize(mesh.positions.size() / 3 * 3);
        std::iota(mesh.indices.begin(), mesh.indices.end(), 0U);
    }
    return solids;
}

}  // namespace viscera::io

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <map>
#include <stdexcept>

#include "engine/core/error.h"
#include "engine/io/file_bytes.h"
#include "engine/io/mesh_readers.h"
#include "engine/io/words.h"

namespace viscera::io {

namespace {

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// One corner of a face: places in the lists of positions, texture coordinates and normals. A place may lie
/// beyond its list: it is looked up only once the list is whole.
using Corner = std::array<std::size_t, 3>;

/// The corners of one object or group, faces split into triangles.
struct Part {
    std::string name;
    std::vector<Corner> corners;
};

class ObjReader {
  public:
    explicit ObjReader(std::string_view text) {
        while (!text.empty()) {
            line_ = take_line(text);
            read_line();
        }
    }

    [[nodiscard]] std::vector<RawMesh> meshes(const std::filesystem::path& file, Log& log) const {
        std::vector<RawMesh> meshes;
        for (const Part& part : parts_) {
            if (!part.corners.empty()) {
                const std::string name = part.name.empty() ? file.stem().string() : part.name;
                const std::string where = file.string() + ": mesh '" + name + "'";
                meshes.push_back({mesh_of(part, where, log), "", false});
                meshes.back().mesh.name = name;
            }
        }
        return meshes;
    }
    [[nodiscard]] std::size_t points_and_lines() const { return points_and_lines_; }

  private:
    void read_line() {
        const std::string_view word = take_word(line_);
        if (word == "v") {
            positions_.push_back(numbers());
        } else if (word == "vt") {
            uvs_.push_back(numbers());
        } else if (word == "vn") {
            normals_.push_back(numbers());
        } else if (word == "f") {
            read_face();
        } else if (word == "o" || word == "g") {
            parts_.push_back({std::string(take_word(line_)), {}});
        } else if (word == "p" || word == "l") {
            ++points_and_lines_;
        }
    }

    /// Up to three numbers; what is missing is 0.
    glm::vec3 numbers() {
        glm::vec3 values(0.0F);
        for (int c = 0; c < 3; ++c) {
            const std::string_view word = take_word(line_);
            const auto value = to_number(word);
            if (!value && !word.empty()) {
                throw std::runtime_error("'" + std::string(word.substr(0, 20)) + "' is no number");
            }
            values[c] = static_cast<float>(value.value_or(0.0));
        }
        return values;
    }

    /// Place named by `text`: counted from 1, or backwards from the last one read so far when negative.
    static std::size_t place(std::string_view text, std::size_t size) {
        if (text.empty()) {
            return none;
        }
        std::int64_t number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc{} || end != text.data() + text.size()) {
            throw std::runtime_error("'" + std::string(text.substr(0, 20)) + "' is no vertex");
        }
        const std::int64_t index = number < 0 ? static_cast<std::int64_t>(size) + number : number - 1;
        return index < 0 ? none - 1 : static_cast<std::size_t>(index);
    }

    Corner parse_corner(std::string_view word) const {
        const std::array<std::size_t, 3> sizes{positions_.size(), uvs_.size(), normals_.size()};
        Corner corner{none, none, none};
        for (std::size_t k = 0; k < 3 && !word.empty(); ++k) {
            const std::size_t slash = word.find('/');
            corner[k] = place(word.substr(0, slash), sizes[k]);
            word.remove_prefix(slash == std::string_view::npos ? word.size() : slash + 1);
        }
        return corner;
    }

    void read_face() {
        std::vector<Corner> corners;
        for (std::string_view word = take_word(line_); !word.empty(); word = take_word(line_)) {
            corners.push_back(parse_corner(word));
        }
        if (corners.size() < 3) {
            throw std::runtime_error("a face has fewer than three corners");
        }
        if (parts_.empty()) {
            parts_.emplace_back();
        }
        for (std::size_t i = 2; i < corners.size(); ++i) {
            parts_.back().corners.insert(parts_.back().corners.end(),
                                         {corners[0], corners[i - 1], corners[i]});
        }
    }

    /// Whether every corner has an entry in a list. What only some have is left out, and said. Corners
    /// without a place do not count: their triangles are dropped.
    [[nodiscard]] bool all_have(const Part& part, std::size_t k, std::size_t size, const char* what,
                                const std::string& where, Log& log) const {
        std::uint64_t with = 0;
        std::uint64_t without = 0;
        for (const Corner& corner : part.corners) {
            if (corner[0] < positions_.size()) {
                ++(corner[k] < size ? with : without);
            }
        }
        if (with > 0 && without > 0) {
            const std::string left_out = std::string(what) + " left out that not all corners have";
            log.fault("mesh: " + left_out,
                      where + ": " + left_out + ": " + std::to_string(without) + " are without", without);
        }
        return without == 0;
    }

    /// One vertex for each different corner. Texture coordinates and normals stay if every corner has them.
    [[nodiscard]] MeshData mesh_of(const Part& part, const std::string& where, Log& log) const {
        const bool has_uvs = all_have(part, 1, uvs_.size(), "texture coordinates", where, log);
        const bool has_normals = all_have(part, 2, normals_.size(), "normals", where, log);
        MeshData mesh;
        std::map<Corner, std::uint32_t> known;
        for (Corner corner : part.corners) {
            if (corner[0] >= positions_.size()) {
                mesh.indices.push_back(std::numeric_limits<std::uint32_t>::max());
                continue;
            }
            corner[1] = has_uvs ? corner[1] : none;
            corner[2] = has_normals ? corner[2] : none;
            const auto next = static_cast<std::uint32_t>(mesh.positions.size());
            const auto [entry, is_new] = known.try_emplace(corner, next);
            mesh.indices.push_back(entry->second);
            if (!is_new) {
                continue;
            }
            mesh.positions.push_back(positions_[corner[0]]);
            if (has_uvs) {
                mesh.uvs.emplace_back(uvs_[corner[1]]);
            }
            if (has_normals) {
                mesh.normals.push_back(normals_[corner[2]]);
            }
        }
        return mesh;
    }

    std::string_view line_;
    std::vector<glm::vec3> positions_;
    std::vector<glm::vec3> uvs_;
    std::vector<glm::vec3> normals_;
    std::vector<Part> parts_;
    std::size_t points_and_lines_ = 0;
};

/// Joins lines that end in a backslash with their next.
std::string join_continued(std::string text) {
    for (std::size_t at = text.find('\\'); at != std::string::npos; at = text.find('\\', at + 1)) {
        const std::size_t end = text.find_first_not_of('\r', at + 1);
        if (end != std::string::npos && text[end] == '\n') {
            std::fill(text.begin() + static_cast<std::ptrdiff_t>(at),
                      text.begin() + static_cast<std::ptrdiff_t>(end) + 1, ' ');
        }
    }
    return text;
}

}  // namespace

std::vector<RawMesh> read_obj(const std::filesystem::path& file, Log& log) {
    const std::string text = join_continued(read_file(file));
    try {
        const ObjReader reader(text);
        if (reader.points_and_lines() > 0) {
            log.fault("mesh: points and lines left out", file.string() + ": points or lines left out",
                      reader.points_and_lines());
        }
        return reader.meshes(file, log);
    } catch (const std::runtime_error& error) {
        throw Error(ErrorCode::file, file.string(), std::string("is no readable OBJ file: ") + error.what());
    }
}

}  // namespace viscera::io

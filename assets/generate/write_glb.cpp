#include "assets/generate/write_glb.h"

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "assets/generate/write_file.h"

namespace viscera::assets {
namespace {

constexpr int float_component = 5126;
constexpr int index_component = 5125;
constexpr int vertex_buffer = 34962;
constexpr int index_buffer = 34963;

/// The binary chunk and the JSON that describes it. Every element is a multiple of four bytes.
class Buffer {
  public:
    template <typename T>
    std::size_t add(const std::vector<T>& values, int component, const char* type, std::size_t count,
                    int target) {
        static_assert(sizeof(T) % 4 == 0);
        const std::size_t bytes = values.size() * sizeof(T);
        views_.push_back(
            {{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", bytes}, {"target", target}});
        accessors_.push_back({{"bufferView", views_.size() - 1},
                              {"componentType", component},
                              {"count", count},
                              {"type", type}});
        const auto* first = reinterpret_cast<const char*>(values.data());
        data_.append(first, bytes);
        return accessors_.size() - 1;
    }
    nlohmann::ordered_json& accessor(std::size_t index) { return accessors_[index]; }
    [[nodiscard]] const nlohmann::ordered_json& views() const { return views_; }
    [[nodiscard]] const nlohmann::ordered_json& accessors() const { return accessors_; }
    [[nodiscard]] const std::string& data() const { return data_; }

  private:
    nlohmann::ordered_json views_ = nlohmann::ordered_json::array();
    nlohmann::ordered_json accessors_ = nlohmann::ordered_json::array();
    std::string data_;
};

void append_little_endian(std::string& file, std::size_t word) {
    for (unsigned shift = 0; shift < 32U; shift += 8U) {
        file.push_back(static_cast<char>((word >> shift) & 0xffU));
    }
}

void append_glb_chunk(std::string& file, const char* type, std::string data, char padding) {
    data.resize((data.size() + 3) / 4 * 4, padding);
    append_little_endian(file, data.size());
    file.append(type, 4);
    file += data;
}

}  // namespace

void write_glb(const MeshData& mesh, const std::filesystem::path& path) {
    Buffer buffer;
    nlohmann::ordered_json attributes;
    std::vector<glm::vec3> metres;
    Bounds box;
    for (const glm::vec3& p : mesh.positions) {
        metres.push_back(p / 1000.0F);
        box.extend(metres.back());
    }
    const std::size_t positions = buffer.add(metres, float_component, "VEC3", metres.size(), vertex_buffer);
    buffer.accessor(positions)["min"] = {box.min.x, box.min.y, box.min.z};
    buffer.accessor(positions)["max"] = {box.max.x, box.max.y, box.max.z};
    attributes["POSITION"] = positions;
    if (!mesh.normals.empty()) {
        attributes["NORMAL"] =
            buffer.add(mesh.normals, float_component, "VEC3", mesh.normals.size(), vertex_buffer);
    }
    if (!mesh.uvs.empty()) {
        // glTF counts v from the top of a picture.
        std::vector<glm::vec2> uvs;
        for (const glm::vec2& uv : mesh.uvs) {
            uvs.emplace_back(uv.x, 1.0F - uv.y);
        }
        attributes["TEXCOORD_0"] = buffer.add(uvs, float_component, "VEC2", uvs.size(), vertex_buffer);
    }
    for (const VertexScalars& scalars : mesh.scalars) {
        attributes[scalars.name] =
            buffer.add(scalars.values, float_component, "SCALAR", scalars.values.size(), vertex_buffer);
    }
    const std::size_t indices =
        buffer.add(mesh.indices, index_component, "SCALAR", mesh.indices.size(), index_buffer);

    nlohmann::ordered_json gltf;
    gltf["asset"] = {{"version", "2.0"}, {"generator", "viscera_assets"}};
    gltf["scene"] = 0;
    gltf["scenes"] = {{{"nodes", {0}}}};
    gltf["nodes"] = {{{"name", mesh.name}, {"mesh", 0}}};
    gltf["meshes"] = {
        {{"name", mesh.name}, {"primitives", {{{"attributes", attributes}, {"indices", indices}}}}}};
    gltf["accessors"] = buffer.accessors();
    gltf["bufferViews"] = buffer.views();
    gltf["buffers"] = {{{"byteLength", buffer.data().size()}}};

    std::string chunks;
    append_glb_chunk(chunks, "JSON", gltf.dump(), ' ');
    append_glb_chunk(chunks, "BIN\0", buffer.data(), '\0');
    std::string file = "glTF";
    append_little_endian(file, 2);
    append_little_endian(file, 12 + chunks.size());
    write_file(path, file + chunks);
}

}  // namespace viscera::assets

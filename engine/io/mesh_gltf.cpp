#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <set>
#include <utility>

#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "engine/core/error.h"
#include "engine/io/gltf_file.h"
#include "engine/io/mesh_readers.h"

// tinygltf's code is made here, under a name of our own so that it does not clash with a host's. It never
// sees a file, an image or an unchecked reference.
#define tinygltf viscera_tinygltf
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

namespace viscera::io {

namespace {

/// Hands the checked buffers to tinygltf under their numbers, in place of a file system.
tinygltf::FsCallbacks memory_callbacks(std::vector<std::string>& buffers) {
    tinygltf::FsCallbacks callbacks{};
    callbacks.FileExists = [](const std::string&, void*) { return true; };
    callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>* out, std::string*, const std::string& path,
                                 void* user) {
        const std::string& bytes = (*static_cast<std::vector<std::string>*>(user))[std::stoul(path)];
        out->assign(bytes.begin(), bytes.end());
        return true;
    };
    callbacks.user_data = &buffers;
    return callbacks;
}

tinygltf::Model load_model(const std::filesystem::path& file, Log& log) {
    GltfFile checked = read_gltf_file(file);
    if (checked.posed > 0) {
        log.fault("mesh: skins and morph targets left out",
                  file.string() + ": skins and morph targets left out: the mesh is as it is without them",
                  checked.posed);
    }
    const std::string text = checked.document.dump();
    tinygltf::Model model;
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks(memory_callbacks(checked.buffers));
    std::string error;
    std::string warning;
    if (text.size() > std::numeric_limits<unsigned>::max() ||
        !loader.LoadASCIIFromString(&model, &error, &warning, text.c_str(),
                                    static_cast<unsigned>(text.size()), "")) {
        throw Error(ErrorCode::file, file.string(), "is no readable glTF file: " + error);
    }
    return model;
}

template <class T>
T load(const unsigned char* bytes) {
    T value{};
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

template <class T>
double load_normalised(const unsigned char* bytes, bool normalised) {
    const double value = static_cast<double>(load<T>(bytes));
    // glTF 2.0, section 3.11: c / max for unsigned, max(c / max, -1) for signed integers.
    return normalised ? std::max(value / static_cast<double>(std::numeric_limits<T>::max()), -1.0) : value;
}

double load_component(const unsigned char* bytes, int type, bool normalised) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return load_normalised<std::int8_t>(bytes, normalised);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return load_normalised<std::uint8_t>(bytes, normalised);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return load_normalised<std::int16_t>(bytes, normalised);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return load_normalised<std::uint16_t>(bytes, normalised);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return load_normalised<std::uint32_t>(bytes, normalised);
        default:
            return static_cast<double>(load<float>(bytes));
    }
}

/// Elements that lie in a buffer view, `stride` bytes apart.
struct Elements {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;
};

Elements elements_at(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t bytes) {
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(view_index)];
    const tinygltf::Buffer& buffer = model.buffers[static_cast<std::size_t>(view.buffer)];
    return {buffer.data.data() + view.byteOffset + offset, view.byteStride != 0 ? view.byteStride : bytes};
}

/// Every value of an accessor as double (exact for all component types), sparse ones put in place.
std::vector<double> read_accessor(const tinygltf::Model& model, int index) {
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(index)];
    const auto components =
        static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<unsigned>(accessor.type)));
    const auto component_bytes = static_cast<std::size_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<unsigned>(accessor.componentType)));
    const std::size_t bytes = components * component_bytes;
    std::vector<double> values(accessor.count * components, 0.0);

    const auto copy = [&](const unsigned char* from, std::size_t to) {
        for (std::size_t c = 0; c < components; ++c) {
            values[to * components + c] =
                load_component(from + c * component_bytes, accessor.componentType, accessor.normalized);
        }
    };
    if (accessor.bufferView >= 0) {
        const Elements all = elements_at(model, accessor.bufferView, accessor.byteOffset, bytes);
        for (std::size_t i = 0; i < accessor.count; ++i) {
            copy(all.first + i * all.stride, i);
        }
    }
    if (accessor.sparse.isSparse) {
        const auto& sparse = accessor.sparse;
        const auto index_bytes = static_cast<std::size_t>(
            tinygltf::GetComponentSizeInBytes(static_cast<unsigned>(sparse.indices.componentType)));
        const Elements places = elements_at(model, sparse.indices.bufferView,
                                            static_cast<std::size_t>(sparse.indices.byteOffset), index_bytes);
        const Elements changed = elements_at(model, sparse.values.bufferView,
                                             static_cast<std::size_t>(sparse.values.byteOffset), bytes);
        for (std::size_t i = 0; i < static_cast<std::size_t>(sparse.count); ++i) {
            const double place =
                load_component(places.first + i * places.stride, sparse.indices.componentType, false);
            if (place < static_cast<double>(accessor.count)) {
                copy(changed.first + i * changed.stride, static_cast<std::size_t>(place));
            }
        }
    }
    return values;
}

glm::dmat4 local_transform(const tinygltf::Node& node) {
    glm::dmat4 matrix(1.0);
    if (node.matrix.size() == 16) {
        return glm::make_mat4(node.matrix.data());
    }
    if (node.rotation.size() == 4) {
        const glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
        const double length = glm::length(q);
        matrix = length > 0.0 ? glm::mat4_cast(q / length) : matrix;
    }
    if (node.scale.size() == 3) {
        for (int c = 0; c < 3; ++c) {
            matrix[c] *= node.scale[static_cast<std::size_t>(c)];
        }
    }
    if (node.translation.size() == 3) {
        matrix[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1.0);
    }
    return matrix;
}

/// Corners of a primitive's triangles; empty for points and lines.
std::vector<std::uint32_t> triangles_of(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                        std::size_t vertices) {
    std::vector<std::uint32_t> corners(vertices);
    if (primitive.indices >= 0) {
        const std::vector<double> values = read_accessor(model, primitive.indices);
        corners.assign(values.begin(), values.end());
    } else {
        for (std::size_t v = 0; v < vertices; ++v) {
            corners[v] = static_cast<std::uint32_t>(v);
        }
    }
    std::vector<std::uint32_t> indices;
    const auto corner = [&](std::size_t i) { return corners[i]; };
    switch (primitive.mode) {
        case TINYGLTF_MODE_TRIANGLES:
            corners.resize(corners.size() / 3 * 3);
            return corners;
        case TINYGLTF_MODE_TRIANGLE_STRIP:
            append_strip(corners.size(), corner, indices);
            break;
        case TINYGLTF_MODE_TRIANGLE_FAN:
            append_fan(corners.size(), corner, indices);
            break;
        default:
            break;
    }
    return indices;
}

MeshData convert(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                 const glm::dmat4& world) {
    MeshData mesh;
    const auto attribute = [&](const std::string& name) {
        const auto found = primitive.attributes.find(name);
        return found == primitive.attributes.end() ? std::vector<double>()
                                                   : read_accessor(model, found->second);
    };
    const std::vector<double> positions = attribute("POSITION");
    for (std::size_t v = 0; v < positions.size() / 3; ++v) {
        mesh.positions.emplace_back(world * glm::dvec4(tuple3(positions, v), 1.0));
    }
    // The cofactor matrix is the inverse transpose but for a factor, and exists for flattened nodes too. For
    // mirrored ones it turns normals as the flipped winding wants them.
    const glm::dmat3 linear(world);
    const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                              glm::cross(linear[0], linear[1]));
    const bool mirrored = glm::determinant(linear) < 0.0;
    const std::vector<double> normals = attribute("NORMAL");
    for (std::size_t v = 0; v < normals.size() / 3; ++v) {
        const glm::dvec3 normal = (mirrored ? -1.0 : 1.0) * (cofactor * tuple3(normals, v));
        const double length = glm::length(normal);
        mesh.normals.emplace_back(length > 0.0 ? normal / length : glm::dvec3(0.0));
    }
    const std::vector<double> uvs = attribute("TEXCOORD_0");
    for (std::size_t v = 0; v < uvs.size() / 2; ++v) {
        // glTF counts v from the top of a picture, MeshData from the bottom.
        mesh.uvs.emplace_back(uvs[2 * v], 1.0 - uvs[2 * v + 1]);
    }
    for (const auto& [name, index] : primitive.attributes) {
        if (name.starts_with("_") &&
            model.accessors[static_cast<std::size_t>(index)].type == TINYGLTF_TYPE_SCALAR) {
            const std::vector<double> values = read_accessor(model, index);
            mesh.scalars.push_back({name, {values.begin(), values.end()}});
        }
    }
    const auto colour = primitive.attributes.find("COLOR_0");
    if (colour != primitive.attributes.end() &&
        model.accessors[static_cast<std::size_t>(colour->second)].type == TINYGLTF_TYPE_VEC4) {
        const std::vector<double> values = read_accessor(model, colour->second);
        VertexScalars alpha{"COLOR_0.a", {}};
        for (std::size_t v = 0; v < values.size() / 4; ++v) {
            alpha.values.push_back(static_cast<float>(values[4 * v + 3]));
        }
        mesh.scalars.push_back(std::move(alpha));
    }
    mesh.indices = triangles_of(model, primitive, mesh.positions.size());
    if (mirrored) {
        for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
            std::swap(mesh.indices[t + 1], mesh.indices[t + 2]);
        }
    }
    return mesh;
}

class GltfScene {
  public:
    GltfScene(const tinygltf::Model& model, const std::filesystem::path& file, Log& log)
        : model_(model), file_(file), log_(log) {}

    std::vector<RawMesh> read() {
        if (model_.nodes.empty()) {
            for (const tinygltf::Mesh& mesh : model_.meshes) {
                add(mesh, "", glm::dmat4(1.0));
            }
        } else {
            walk(roots());
        }
        return std::move(meshes_);
    }

  private:
    [[nodiscard]] std::vector<int> roots() const {
        if (!model_.scenes.empty()) {
            return model_.scenes[static_cast<std::size_t>(std::max(model_.defaultScene, 0))].nodes;
        }
        std::set<int> children;
        for (const tinygltf::Node& node : model_.nodes) {
            children.insert(node.children.begin(), node.children.end());
        }
        std::vector<int> roots;
        for (int i = 0; i < static_cast<int>(model_.nodes.size()); ++i) {
            if (!children.contains(i)) {
                roots.push_back(i);
            }
        }
        return roots;
    }

    /// Depth first in the file's order, with a list of its own since a file may nest without bound.
    void walk(const std::vector<int>& roots) {
        std::vector<std::pair<int, glm::dmat4>> open;
        const auto push = [&](const std::vector<int>& nodes, const glm::dmat4& world) {
            for (auto i = nodes.rbegin(); i != nodes.rend(); ++i) {
                open.emplace_back(*i, world);
            }
        };
        push(roots, glm::dmat4(1.0));
        while (!open.empty()) {
            const auto [index, parent] = open.back();
            open.pop_back();
            const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
            const glm::dmat4 world = parent * local_transform(node);
            if (node.mesh >= 0) {
                add(model_.meshes[static_cast<std::size_t>(node.mesh)], node.name, world);
            }
            push(node.children, world);
        }
    }

    void add(const tinygltf::Mesh& mesh, const std::string& node_name, const glm::dmat4& world) {
        std::vector<MeshData> parts;
        for (const tinygltf::Primitive& primitive : mesh.primitives) {
            if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
                log_.fault("mesh: points and lines left out",
                           file_.string() + ": mesh '" + mesh.name + "' has points or lines, left out");
            } else if (!primitive.attributes.contains("POSITION")) {
                log_.fault("mesh: parts without positions left out",
                           file_.string() + ": mesh '" + mesh.name + "' has a part without positions");
            } else {
                count_vertices(primitive);
                parts.push_back(convert(model_, primitive, world));
            }
        }
        RawMesh raw{parts.size() == 1 ? std::move(parts.front()) : concatenate(parts), mesh.name, false};
        raw.mesh.name = node_name.empty() ? mesh.name : node_name;
        meshes_.push_back(std::move(raw));
    }

    /// Many nodes may show one mesh: a small file can ask for any amount of memory.
    void count_vertices(const tinygltf::Primitive& primitive) {
        constexpr std::size_t most_vertices = std::size_t{1} << 27U;
        const auto count = [&](int index) { return model_.accessors[static_cast<std::size_t>(index)].count; };
        vertices_ += count(primitive.attributes.at("POSITION"));
        vertices_ += primitive.indices >= 0 ? count(primitive.indices) : 0;
        if (vertices_ > most_vertices) {
            throw Error(ErrorCode::limit, file_.string(), "has more vertices and indices than are read");
        }
    }

    const tinygltf::Model& model_;
    const std::filesystem::path& file_;
    Log& log_;
    std::vector<RawMesh> meshes_;
    std::size_t vertices_ = 0;
};

}  // namespace

std::vector<RawMesh> read_gltf(const std::filesystem::path& file, Log& log) {
    const tinygltf::Model model = load_model(file, log);
    return GltfScene(model, file, log).read();
}

}  // namespace viscera::io

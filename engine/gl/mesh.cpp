#include "engine/gl/mesh.h"

#include <algorithm>
#include <array>

#include "engine/core/error.h"

namespace viscera::gl {
namespace {

// Read by every instance, since no draw reaches this many: a constant without touching the context's current
// attribute values.
constexpr GLuint constant_divisor = 0x7FFFFFFF;

constexpr std::array optional_attributes{Attribute::normal, Attribute::uv, Attribute::scalar,
                                         Attribute::picture_uv};
constexpr std::array<float, 4> zero{};

constexpr GLuint location(Attribute attribute) {
    return static_cast<GLuint>(attribute);
}

}  // namespace

Mesh::Mesh(const Functions& gl, const MeshData& data)
    : vertex_array_(gl),
      zero_(gl, std::as_bytes(std::span(zero)), BufferUsage::fixed),
      indices_(gl, std::size_t{0}, BufferUsage::dynamic),
      vertex_count_(data.positions.size()) {
    for (const Attribute attribute : optional_attributes) {
        set_zero(attribute);
    }
    update_positions(data.positions);
    if (!data.normals.empty()) {
        update_normals(data.normals);
    }
    if (!data.uvs.empty()) {
        update_uvs(data.uvs);
    }
    for (const VertexScalars& scalar : data.scalars) {
        update_scalars(scalar.name, scalar.values);
    }
    if (!data.scalars.empty()) {
        select_scalar(data.scalars.front().name);
    }
    vertex_array_.set_indices(indices_);
    update_indices(data.indices);
}

std::size_t Mesh::bytes() const {
    std::size_t sum = zero_.bytes() + indices_.bytes();
    for (const Stream& stream : streams_) {
        sum += stream.buffer.bytes();
    }
    for (const Scalar& scalar : scalars_) {
        sum += scalar.buffer.bytes();
    }
    return sum;
}

void Mesh::check_count(std::size_t count, std::string_view what) const {
    if (count != vertex_count_) {
        throw Error(ErrorCode::usage, "mesh",
                    std::to_string(count) + " " + std::string(what) + " for " +
                        std::to_string(vertex_count_) + " vertices");
    }
}

void Mesh::update(Attribute attribute, GLint components, std::size_t count,
                  std::span<const std::byte> content, std::string_view what) {
    check_count(count, what);
    const auto found = std::ranges::find(streams_, attribute, &Stream::attribute);
    if (found != streams_.end()) {
        found->buffer.upload(content);
        return;
    }
    streams_.push_back({attribute, Buffer(zero_.gl(), content, BufferUsage::dynamic)});
    vertex_array_.set_attribute(streams_.back().buffer,
                                {.location = location(attribute), .components = components});
}

void Mesh::update_positions(std::span<const glm::vec3> positions) {
    update(Attribute::position, 3, positions.size(), std::as_bytes(positions), "positions");
}
void Mesh::update_normals(std::span<const glm::vec3> normals) {
    update(Attribute::normal, 3, normals.size(), std::as_bytes(normals), "normals");
}
void Mesh::update_uvs(std::span<const glm::vec2> uvs) {
    update(Attribute::uv, 2, uvs.size(), std::as_bytes(uvs), "texture coordinates");
}
void Mesh::update_picture_uvs(std::span<const glm::vec2> uvs) {
    update(Attribute::picture_uv, 2, uvs.size(), std::as_bytes(uvs), "texture coordinates");
}

void Mesh::update_scalars(std::string_view name, std::span<const float> values) {
    check_count(values.size(), "scalars");
    const auto found = std::ranges::find(scalars_, name, &Scalar::name);
    if (found != scalars_.end()) {
        found->buffer.upload(std::as_bytes(values));
        return;
    }
    scalars_.push_back({std::string(name), Buffer(zero_.gl(), std::as_bytes(values), BufferUsage::stream)});
}

void Mesh::update_indices(std::span<const std::uint32_t> indices) {
    if (indices.size() % 3 != 0) {
        throw Error(ErrorCode::usage, "mesh", std::to_string(indices.size()) + " indices are no triangles");
    }
    // An index beyond the vertices is undefined behaviour on the GPU.
    const std::uint32_t largest = indices.empty() ? 0 : std::ranges::max(indices);
    if (!indices.empty() && largest >= vertex_count_) {
        throw Error(
            ErrorCode::usage, "mesh",
            "index " + std::to_string(largest) + " for " + std::to_string(vertex_count_) + " vertices");
    }
    indices_.upload(std::as_bytes(indices));
    index_count_ = indices.size();
}

bool Mesh::select_scalar(std::string_view name) {
    const auto found = std::ranges::find(scalars_, name, &Scalar::name);
    if (found == scalars_.end()) {
        set_zero(Attribute::scalar);
        return false;
    }
    vertex_array_.set_attribute(found->buffer, {.location = location(Attribute::scalar), .components = 1});
    return true;
}

void Mesh::set_zero(Attribute attribute) {
    vertex_array_.set_attribute(
        zero_, {.location = location(attribute), .components = 4, .divisor = constant_divisor});
}

void Mesh::draw_range(std::size_t first, std::size_t count) const {
    const std::size_t begin = std::min(first, triangle_count());
    const std::size_t length = std::min(count, triangle_count() - begin);
    if (length == 0) {
        return;
    }
    vertex_array_.bind();
    zero_.gl().DrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * length), GL_UNSIGNED_INT,
                            reinterpret_cast<const void*>(3 * begin * sizeof(std::uint32_t)));
}

}  // namespace viscera::gl

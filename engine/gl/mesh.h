#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/mesh_data.h"
#include "engine/gl/buffer.h"

namespace viscera::gl {

/// Where vertex shaders find their inputs; Program binds the names "a_position" ... to these. picture_uv:
/// where the mesh's pictures lie, when uv is an atlas made for it.
enum class Attribute : GLuint { position = 0, normal = 1, uv = 2, scalar = 3, picture_uv = 4 };

/// A triangle mesh in GPU memory, each attribute in a buffer of its own so that it can be replaced alone.
/// Attributes that the mesh lacks read as 0, not as the context's current values, which may be a host's.
class Mesh {
  public:
    /// The first scalar of `data`, if any, is the one that shaders see.
    Mesh(const Functions& gl, const MeshData& data);

    [[nodiscard]] std::size_t triangle_count() const { return index_count_ / 3; }
    /// Of all buffers.
    [[nodiscard]] std::size_t bytes() const;

    /// Replace what is there, one value per vertex, without reallocation. Throws Error(usage) for another
    /// count.
    void update_positions(std::span<const glm::vec3> positions);
    void update_normals(std::span<const glm::vec3> normals);
    void update_uvs(std::span<const glm::vec2> uvs);
    void update_picture_uvs(std::span<const glm::vec2> uvs);
    /// Replaces or adds the scalar `name`.
    void update_scalars(std::string_view name, std::span<const float> values);
    /// New triangles, of any number, in the order in which they are to be drawn. Throws Error(usage) when an
    /// index is out of range or the count is no multiple of 3.
    void update_indices(std::span<const std::uint32_t> indices);

    /// Makes `name` what shaders see as a_scalar. False, and 0 for every vertex, when the mesh has none.
    bool select_scalar(std::string_view name);

    void draw() const { draw_range(0, triangle_count()); }
    /// Triangles [first, first + count), clipped to what there is.
    void draw_range(std::size_t first, std::size_t count) const;

  private:
    struct Scalar {
        std::string name;
        Buffer buffer;
    };
    struct Stream {
        Attribute attribute;
        Buffer buffer;
    };
    void update(Attribute attribute, GLint components, std::size_t count, std::span<const std::byte> content,
                std::string_view what);
    void check_count(std::size_t count, std::string_view what) const;
    void set_zero(Attribute attribute);

    VertexArray vertex_array_;
    Buffer zero_;
    Buffer indices_;
    std::vector<Stream> streams_;
    std::vector<Scalar> scalars_;
    std::size_t vertex_count_ = 0;
    std::size_t index_count_ = 0;
};

}  // namespace viscera::gl

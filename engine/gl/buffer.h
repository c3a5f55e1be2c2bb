#pragma once

#include <cstddef>
#include <span>

#include "engine/gl/handle.h"

namespace viscera::gl {

/// How often a buffer's content changes: once, now and then, every frame, or written by the GPU and read
/// here.
enum class BufferUsage { fixed, dynamic, stream, read_back };

/// Memory of the GPU for vertices, indices, uniforms or pixels. Edits go through GL_COPY_WRITE_BUFFER, which
/// nothing draws from, so that neither a vertex array nor a pixel transfer notices.
class Buffer {
  public:
    /// Uninitialised. Throws Error(limit) when out of memory.
    Buffer(const Functions& gl, std::size_t bytes, BufferUsage usage);
    Buffer(const Functions& gl, std::span<const std::byte> content, BufferUsage usage);

    [[nodiscard]] GLuint id() const { return handle_.id(); }
    [[nodiscard]] std::size_t bytes() const { return bytes_; }
    [[nodiscard]] const Functions& gl() const { return handle_.gl(); }

    /// New content of any size. The old storage is orphaned, so this never waits for draws that still use it;
    /// the size stays allocated when it does not change.
    void upload(std::span<const std::byte> content);
    /// Overwrites a part in place. Throws Error(usage) when it lies outside.
    void update(std::size_t offset, std::span<const std::byte> content);

    void bind(GLenum target) const { gl().BindBuffer(target, id()); }

  private:
    void allocate(std::size_t bytes, const std::byte* content);

    BufferHandle handle_;
    std::size_t bytes_ = 0;
    BufferUsage usage_ = BufferUsage::fixed;
};

/// Floats in a vertex array: `components` per vertex.
struct VertexAttribute {
    GLuint location = 0;
    GLint components = 4;
    GLsizei stride = 0;      ///< [bytes]; 0: tightly packed
    std::size_t offset = 0;  ///< [bytes]
    GLuint divisor = 0;      ///< 0: per vertex; n: per n instances
};

/// Where a draw finds its vertices. Without attributes it serves draws that make vertices of gl_VertexID.
class VertexArray {
  public:
    explicit VertexArray(const Functions& gl);

    [[nodiscard]] GLuint id() const { return handle_.id(); }
    void bind() const { handle_.gl().BindVertexArray(id()); }
    /// Both bind the vertex array. The buffer must outlive it.
    void set_attribute(const Buffer& buffer, const VertexAttribute& attribute);
    void set_indices(const Buffer& buffer);

  private:
    VertexArrayHandle handle_;
};

}  // namespace viscera::gl

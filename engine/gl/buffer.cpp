#include "engine/gl/buffer.h"

#include <string>

#include "engine/core/error.h"

namespace viscera::gl {
namespace {

BufferHandle make_buffer(const Functions& gl) {
    GLuint id = 0;
    gl.GenBuffers(1, &id);
    return BufferHandle::own(gl, id);
}

VertexArrayHandle make_vertex_array(const Functions& gl) {
    GLuint id = 0;
    gl.GenVertexArrays(1, &id);
    return VertexArrayHandle::own(gl, id);
}

GLenum to_gl(BufferUsage usage) {
    switch (usage) {
        case BufferUsage::fixed:
            return GL_STATIC_DRAW;
        case BufferUsage::dynamic:
            return GL_DYNAMIC_DRAW;
        case BufferUsage::stream:
            return GL_STREAM_DRAW;
        case BufferUsage::read_back:
            return GL_STREAM_READ;
    }
    return GL_STATIC_DRAW;
}

}  // namespace

Buffer::Buffer(const Functions& gl, std::size_t bytes, BufferUsage usage)
    : handle_(make_buffer(gl)), usage_(usage) {
    allocate(bytes, nullptr);
}

Buffer::Buffer(const Functions& gl, std::span<const std::byte> content, BufferUsage usage)
    : handle_(make_buffer(gl)), usage_(usage) {
    allocate(content.size(), content.data());
}

void Buffer::allocate(std::size_t bytes, const std::byte* content) {
    bind(GL_COPY_WRITE_BUFFER);
    drain_errors(gl());
    gl().BufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(bytes), content, to_gl(usage_));
    if (const GLenum error = drain_errors(gl()); error != GL_NO_ERROR) {
        throw Error(ErrorCode::limit, "buffer",
                    std::to_string(bytes) + " bytes cannot be had: " + error_name(error));
    }
    bytes_ = bytes;
}

void Buffer::upload(std::span<const std::byte> content) {
    if (content.size() != bytes_) {
        allocate(content.size(), content.data());
        return;
    }
    bind(GL_COPY_WRITE_BUFFER);
    gl().BufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(bytes_), content.data(), to_gl(usage_));
}

void Buffer::update(std::size_t offset, std::span<const std::byte> content) {
    if (offset > bytes_ || content.size() > bytes_ - offset) {
        throw Error(ErrorCode::usage, "buffer",
                    std::to_string(content.size()) + " bytes at " + std::to_string(offset) +
                        " lie outside its " + std::to_string(bytes_));
    }
    bind(GL_COPY_WRITE_BUFFER);
    gl().BufferSubData(GL_COPY_WRITE_BUFFER, static_cast<GLintptr>(offset),
                       static_cast<GLsizeiptr>(content.size()), content.data());
}

VertexArray::VertexArray(const Functions& gl) : handle_(make_vertex_array(gl)) {}

void VertexArray::set_attribute(const Buffer& buffer, const VertexAttribute& attribute) {
    const Functions& gl = handle_.gl();
    bind();
    buffer.bind(GL_ARRAY_BUFFER);
    gl.EnableVertexAttribArray(attribute.location);
    gl.VertexAttribPointer(attribute.location, attribute.components, GL_FLOAT, GL_FALSE, attribute.stride,
                           reinterpret_cast<const void*>(attribute.offset));
    gl.VertexAttribDivisor(attribute.location, attribute.divisor);
}

void VertexArray::set_indices(const Buffer& buffer) {
    bind();
    buffer.bind(GL_ELEMENT_ARRAY_BUFFER);
}

}  // namespace viscera::gl

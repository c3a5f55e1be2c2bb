#pragma once

#include <algorithm>
#include <array>
#include <bit>

#include "engine/gl/handle.h"
#include "engine/gl/host_state_rows.h"

// What the rows of host state are written with: values of all types as 64-bit integers.
namespace viscera::gl {

using Values = std::span<GLint64>;
using Saved = std::span<const GLint64>;

inline GLenum as_enum(GLint64 value) {
    return static_cast<GLenum>(value);
}
inline GLint as_int(GLint64 value) {
    return static_cast<GLint>(value);
}
inline GLboolean as_bool(GLint64 value) {
    return value != 0 ? GL_TRUE : GL_FALSE;
}
inline GLfloat as_float(GLint64 value) {
    return std::bit_cast<GLfloat>(static_cast<GLint>(value));
}
inline GLdouble as_double(GLint64 value) {
    return std::bit_cast<GLdouble>(value);
}

// Room for what drivers may write: some answer GL_POLYGON_MODE with two values.
using Answer = std::array<GLint, 16>;

/// Of values that there are `count` times per viewport, draw buffer or binding, those of one.
template <class Span>
Span part(Span all, GLuint index, std::size_t count) {
    return all.subspan(count * index, count);
}

inline void read_ints(const Functions& gl, GLenum name, Values out) {
    Answer answer{};
    gl.GetIntegerv(name, answer.data());
    std::copy_n(answer.begin(), out.size(), out.begin());
}

inline void read_floats(const Functions& gl, GLenum name, Values out) {
    std::array<GLfloat, 16> answer{};
    gl.GetFloatv(name, answer.data());
    std::transform(answer.begin(), answer.begin() + static_cast<std::ptrdiff_t>(out.size()), out.begin(),
                   [](GLfloat value) { return static_cast<GLint64>(std::bit_cast<GLint>(value)); });
}

inline bool always(const Functions& /*gl*/) {
    return true;
}
inline bool has_4_0(const Functions& gl) {
    return gl.VERSION_4_0 != 0;
}
inline bool has_4_3(const Functions& gl) {
    return gl.VERSION_4_3 != 0;
}
inline bool has_clip_control(const Functions& gl) {
    return gl.ARB_clip_control != 0;
}

}  // namespace viscera::gl

#include "engine/gl/debug.h"

#include <algorithm>
#include <string>

#include "engine/gl/handle.h"

namespace viscera::gl {

namespace {

/// Length of `text` cut to a limit that counts the terminating zero, as the driver's does.
GLsizei cut_length(const Functions& gl, GLenum limit_name, std::string_view text) {
    GLint limit = 0;
    gl.GetIntegerv(limit_name, &limit);
    return static_cast<GLsizei>(std::min(text.size(), static_cast<std::size_t>(std::max(limit - 1, 1))));
}

LogLevel level_of(GLenum type) {
    switch (type) {
        case GL_DEBUG_TYPE_ERROR:
            return LogLevel::error;
        case GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR:
        case GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR:
        case GL_DEBUG_TYPE_PORTABILITY:
            return LogLevel::warning;
        default:
            return LogLevel::debug;
    }
}

void GLAPIENTRY receive(GLenum, GLenum type, GLuint, GLenum, GLsizei length, const GLchar* message,
                        const void* user) {
    // Groups announce themselves as messages; that is noise here.
    if (type == GL_DEBUG_TYPE_PUSH_GROUP || type == GL_DEBUG_TYPE_POP_GROUP) {
        return;
    }
    std::string_view text =
        length >= 0 ? std::string_view(message, static_cast<std::size_t>(length)) : std::string_view(message);
    while (!text.empty() && (text.back() == '\n' || text.back() == '\0')) {
        text.remove_suffix(1);
    }
    auto* log = static_cast<Log*>(const_cast<void*>(user));
    try {
        log->write(level_of(type), "OpenGL: " + std::string(text));
    } catch (...) {
        // An exception must not pass through the driver; a lost message is the lesser harm.
    }
}

}  // namespace

bool has_debug(const Functions& gl) {
    return (gl.KHR_debug != 0 || gl.VERSION_4_3 != 0) && gl.DebugMessageCallback != nullptr &&
           gl.ObjectLabel != nullptr && gl.PushDebugGroup != nullptr && gl.PopDebugGroup != nullptr &&
           gl.GetPointerv != nullptr;
}

void label_object(const Functions& gl, GLenum kind, GLuint name, std::string_view label) {
    if (has_debug(gl) && name != 0 && !label.empty()) {
        gl.ObjectLabel(kind, name, cut_length(gl, GL_MAX_LABEL_LENGTH, label), label.data());
    }
}

DebugGroup::DebugGroup(const Functions& gl, std::string_view name) {
    if (has_debug(gl) && !name.empty()) {
        gl.PushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, cut_length(gl, GL_MAX_DEBUG_MESSAGE_LENGTH, name),
                          name.data());
        gl_ = &gl;
    }
}

DebugGroup::~DebugGroup() {
    if (gl_ != nullptr) {
        gl_->PopDebugGroup();
    }
}

DebugMessages::DebugMessages(const Functions& gl, Log& log) {
    if (!has_debug(gl)) {
        return;
    }
    gl_ = &gl;
    gl.GetPointerv(GL_DEBUG_CALLBACK_FUNCTION, &callback_before_);
    gl.GetPointerv(GL_DEBUG_CALLBACK_USER_PARAM, &user_before_);
    output_before_ = gl.IsEnabled(GL_DEBUG_OUTPUT) == GL_TRUE;
    synchronous_before_ = gl.IsEnabled(GL_DEBUG_OUTPUT_SYNCHRONOUS) == GL_TRUE;
    gl.DebugMessageCallback(receive, &log);
    gl.Enable(GL_DEBUG_OUTPUT);
    gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
}

DebugMessages::~DebugMessages() {
    if (gl_ == nullptr) {
        return;
    }
    gl_->DebugMessageCallback(reinterpret_cast<GLDEBUGPROC>(callback_before_), user_before_);
    toggle(*gl_, GL_DEBUG_OUTPUT, output_before_);
    toggle(*gl_, GL_DEBUG_OUTPUT_SYNCHRONOUS, synchronous_before_);
}

}  // namespace viscera::gl

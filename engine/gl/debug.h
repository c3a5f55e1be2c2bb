#pragma once

#include <string_view>

#include "engine/core/log.h"
#include "engine/gl/functions.h"

namespace viscera::gl {

// What debuggers and drivers say and show through KHR_debug. All of it does nothing where a context has none.

[[nodiscard]] bool has_debug(const Functions& gl);

/// Names an object for debuggers and driver messages. `kind`: GL_TEXTURE, GL_FRAMEBUFFER, GL_BUFFER,
/// GL_PROGRAM, ... The object must have been bound once. Labels longer than the driver takes are cut.
void label_object(const Functions& gl, GLenum kind, GLuint name, std::string_view label);

/// Groups the calls of its scope under a name.
class DebugGroup {
  public:
    DebugGroup(const Functions& gl, std::string_view name);
    DebugGroup(const DebugGroup&) = delete;
    DebugGroup& operator=(const DebugGroup&) = delete;
    ~DebugGroup();

  private:
    const Functions* gl_ = nullptr;  ///< null: there is no group to close
};

/// Sends the driver's messages to a log while it lives: errors as errors, undefined and deprecated behaviour
/// as warnings, performance hints and the rest as debug. They come at the call that caused them. Puts back
/// the callback and the switches that it found, so that a host's own survive. `log` must live as long.
class DebugMessages {
  public:
    DebugMessages(const Functions& gl, Log& log);
    DebugMessages(const DebugMessages&) = delete;
    DebugMessages& operator=(const DebugMessages&) = delete;
    ~DebugMessages();

    /// Whether the context sends messages at all.
    [[nodiscard]] bool active() const { return gl_ != nullptr; }

  private:
    const Functions* gl_ = nullptr;
    void* callback_before_ = nullptr;
    void* user_before_ = nullptr;
    bool output_before_ = false;
    bool synchronous_before_ = false;
};

}  // namespace viscera::gl

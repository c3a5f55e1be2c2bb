#pragma once

#include <memory>

#include "engine/context/context.h"
#include "engine/gl/glad/gl.h"

namespace viscera::gl {

/// OpenGL's functions for one context: `gl.Clear(GL_COLOR_BUFFER_BIT)`. Functions above core 3.3 and of
/// extensions are null where the context does not have them; VERSION_4_3, KHR_debug and their like say which
/// are there. Each context has a table of its own: never call one context's functions while another is
/// current.
struct Functions : GladGLContext {
    /// Loads for the context that is current on this thread. Throws Error(context) when none is current, when
    /// it is OpenGL ES or below 3.3, or when a function of core 3.3 is missing.
    [[nodiscard]] static std::unique_ptr<const Functions> load(ProcAddress proc);
};

}  // namespace viscera::gl

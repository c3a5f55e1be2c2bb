#pragma once

#include "engine/gl/functions.h"

namespace viscera::gl {

/// What a context can do, asked once.
struct Capabilities {
    bool software = false;       ///< renders on the CPU: GPU timers do not tell the truth there
    int max_texture_2d = 0;      ///< [pixels], as the driver says, not what memory allows
    bool debug_context = false;  ///< made with the debug flag
    bool compute = false;        ///< compute shaders, image stores and storage buffers: core 4.3
    int timer_bits = 0;          ///< of GL_TIME_ELAPSED; 0: no timer queries

    [[nodiscard]] static Capabilities query(const Functions& gl);
    /// GPU timers may be believed.
    [[nodiscard]] bool gpu_timers() const { return timer_bits > 0 && !software; }
};

}  // namespace viscera::gl

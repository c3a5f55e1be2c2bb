#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "engine/gl/functions.h"

namespace viscera::gl {

/// What a context can do, asked once. Limits are what the driver says, not what memory allows.
struct Capabilities {
    std::string vendor;
    std::string renderer;
    std::string version;
    int major = 0;
    int minor = 0;
    bool software = false;  ///< renders on the CPU: GPU timers do not tell the truth there

    int max_texture_2d = 0;     ///< [pixels]
    int max_texture_3d = 0;     ///< [voxels along an axis]
    int max_array_layers = 0;   ///< of a 2-D texture array
    int max_buffer_texels = 0;  ///< of a buffer texture
    int max_viewport_width = 0;
    int max_viewport_height = 0;
    int max_draw_buffers = 0;
    int max_colour_attachments = 0;
    int max_fragment_units = 0;  ///< texture units of a fragment shader
    int max_vertex_units = 0;    ///< texture units of a vertex shader
    int max_uniform_buffer_bytes = 0;
    int max_uniform_bindings = 0;
    int uniform_offset_bytes = 0;  ///< alignment of a range bound with glBindBufferRange
    int max_vertex_attributes = 0;
    int max_samples = 0;

    bool debug_messages = false;  ///< KHR_debug, or core 4.3
    bool debug_context = false;   ///< made with the debug flag
    bool buffer_storage = false;  ///< ARB_buffer_storage
    bool compute = false;         ///< compute shaders, image stores and storage buffers: core 4.3
    int timer_bits = 0;           ///< of GL_TIME_ELAPSED; 0: no timer queries

    [[nodiscard]] static Capabilities query(const Functions& gl);
    [[nodiscard]] bool at_least(int wanted_major, int wanted_minor) const {
        return major > wanted_major || (major == wanted_major && minor >= wanted_minor);
    }
    /// GPU timers may be believed.
    [[nodiscard]] bool gpu_timers() const { return timer_bits > 0 && !software; }
};

/// Whether the context lists an extension: "GL_KHR_debug".
[[nodiscard]] bool has_extension(const Functions& gl, std::string_view name);

}  // namespace viscera::gl

#include "engine/gl/capabilities.h"

#include <array>

#include "engine/context/context_info.h"

namespace viscera::gl {

namespace {

std::string text_of(const Functions& gl, GLenum name) {
    const auto* text = reinterpret_cast<const char*>(gl.GetString(name));
    return text != nullptr ? text : "";
}

int integer_of(const Functions& gl, GLenum name) {
    GLint value = 0;
    gl.GetIntegerv(name, &value);
    return value;
}

}  // namespace

bool has_extension(const Functions& gl, std::string_view name) {
    const auto count = static_cast<GLuint>(integer_of(gl, GL_NUM_EXTENSIONS));
    for (GLuint i = 0; i < count; ++i) {
        const auto* listed = reinterpret_cast<const char*>(gl.GetStringi(GL_EXTENSIONS, i));
        if (listed != nullptr && name == listed) {
            return true;
        }
    }
    return false;
}

Capabilities Capabilities::query(const Functions& gl) {
    Capabilities c;
    c.vendor = text_of(gl, GL_VENDOR);
    c.renderer = text_of(gl, GL_RENDERER);
    c.version = text_of(gl, GL_VERSION);
    c.major = integer_of(gl, GL_MAJOR_VERSION);
    c.minor = integer_of(gl, GL_MINOR_VERSION);
    c.software = is_software_renderer(c.renderer);

    c.max_texture_2d = integer_of(gl, GL_MAX_TEXTURE_SIZE);
    c.max_texture_3d = integer_of(gl, GL_MAX_3D_TEXTURE_SIZE);
    c.max_array_layers = integer_of(gl, GL_MAX_ARRAY_TEXTURE_LAYERS);
    c.max_buffer_texels = integer_of(gl, GL_MAX_TEXTURE_BUFFER_SIZE);
    std::array<GLint, 2> viewport{};
    gl.GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
    c.max_viewport_width = viewport[0];
    c.max_viewport_height = viewport[1];
    c.max_draw_buffers = integer_of(gl, GL_MAX_DRAW_BUFFERS);
    c.max_colour_attachments = integer_of(gl, GL_MAX_COLOR_ATTACHMENTS);
    c.max_fragment_units = integer_of(gl, GL_MAX_TEXTURE_IMAGE_UNITS);
    c.max_vertex_units = integer_of(gl, GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS);
    c.max_uniform_buffer_bytes = integer_of(gl, GL_MAX_UNIFORM_BLOCK_SIZE);
    c.max_uniform_bindings = integer_of(gl, GL_MAX_UNIFORM_BUFFER_BINDINGS);
    c.uniform_offset_bytes = integer_of(gl, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT);
    c.max_vertex_attributes = integer_of(gl, GL_MAX_VERTEX_ATTRIBS);
    c.max_samples = integer_of(gl, GL_MAX_SAMPLES);

    c.debug_messages = gl.KHR_debug != 0 || gl.VERSION_4_3 != 0;
    c.debug_context = (integer_of(gl, GL_CONTEXT_FLAGS) & GL_CONTEXT_FLAG_DEBUG_BIT) != 0;
    c.buffer_storage = gl.ARB_buffer_storage != 0;
    c.compute = gl.VERSION_4_3 != 0;
    gl.GetQueryiv(GL_TIME_ELAPSED, GL_QUERY_COUNTER_BITS, &c.timer_bits);
    return c;
}

}  // namespace viscera::gl

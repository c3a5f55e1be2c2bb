#include "engine/gl/capabilities.h"

#include "engine/context/context_info.h"

namespace viscera::gl {
namespace {

int integer_of(const Functions& gl, GLenum name) {
    GLint value = 0;
    gl.GetIntegerv(name, &value);
    return value;
}

}  // namespace

Capabilities Capabilities::query(const Functions& gl) {
    Capabilities c;
    c.software = is_software_renderer(reinterpret_cast<const char*>(gl.GetString(GL_RENDERER)));
    c.max_texture_2d = integer_of(gl, GL_MAX_TEXTURE_SIZE);
    c.debug_context = (integer_of(gl, GL_CONTEXT_FLAGS) & GL_CONTEXT_FLAG_DEBUG_BIT) != 0;
    c.compute = gl.VERSION_4_3 != 0;
    gl.GetQueryiv(GL_TIME_ELAPSED, GL_QUERY_COUNTER_BITS, &c.timer_bits);
    return c;
}

}  // namespace viscera::gl

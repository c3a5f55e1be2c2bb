#version 330 core
#include "volume/ray_cast_body.glsl"
layout(location = 0) out vec4 o_colour;

void main() {
#ifdef MIXED_FINE
    if (!is_cast(ivec2(gl_FragCoord.xy))) {
        discard;
    }
#endif
    o_colour = cast_ray(gl_FragCoord.xy);
}

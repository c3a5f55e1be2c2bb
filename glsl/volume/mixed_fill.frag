#version 330 core
#include "volume/mixed_fill.glsl"
layout(location = 0) out vec4 o_colour;

void main() {
    if (is_cast(ivec2(gl_FragCoord.xy))) {
        discard;
    }
    o_colour = fill_in(gl_FragCoord.xy);
}

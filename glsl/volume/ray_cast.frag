#version 330 core
#include "volume/ray_cast_body.glsl"
layout(location = 0) out vec4 o_colour;

void main() {
    o_colour = cast_ray(gl_FragCoord.xy);
}

#version 330 core
#include "bench/ray_count.glsl"
layout(location = 0) out vec4 o_colour;

void main() {
    o_colour = count_ray(gl_FragCoord.xy);
}

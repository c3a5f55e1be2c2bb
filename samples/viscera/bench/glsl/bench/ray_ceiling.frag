#version 330 core
#include "bench/ray_ceiling.glsl"
layout(location = 0) out vec4 o_colour;

void main() {
    o_colour = sum_ray(gl_FragCoord.xy);
}

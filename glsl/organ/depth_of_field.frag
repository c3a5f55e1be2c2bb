#version 330 core
#include "organ/depth_of_field.glsl"
layout(location = 0) out vec4 o_colour;

void main() {
    o_colour = blurred(gl_FragCoord.xy);
}

#version 330 core
#include "volume/mixed_plan.glsl"
layout(location = 0) out vec4 o_plan;

void main() {
    o_plan = plan_tile(ivec2(gl_FragCoord.xy));
}

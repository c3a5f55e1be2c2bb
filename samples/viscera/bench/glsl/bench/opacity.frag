#version 330 core
// The opacity curve alone, over all of its range.
#ifdef LOOP
#include "bench/opacity_loop.glsl"
#else
#include "contrast/opacity.glsl"
#endif
in vec2 v_uv;
layout(location = 0) out vec4 o_value;

void main() {
    o_value = vec4(contrast_opacity(v_uv.x));
}

#version 330 core
// Fetches each input once and combines them with nothing dearer than a maximum: what any pass over the same pictures must cost. The
// fifth input has a quarter of the target's width and height.
uniform sampler2D u_a;
uniform sampler2D u_b;
uniform sampler2D u_c;
uniform sampler2D u_d;
uniform sampler2D u_e;
layout(location = 0) out vec4 o_value;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 value = texelFetch(u_a, pixel, 0);
#if INPUTS > 1
    value = max(value, texelFetch(u_b, pixel, 0).rgrg);
#endif
#if INPUTS > 2
    value = max(value, texelFetch(u_c, pixel, 0));
#endif
#if INPUTS > 3
    value = max(value, texelFetch(u_d, pixel, 0));
#endif
#if INPUTS > 4
    value = max(value, texelFetch(u_e, pixel >> 2, 0));
#endif
    o_value = value;
}

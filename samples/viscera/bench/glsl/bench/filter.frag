#version 330 core
// One sample per pixel. Places lie on planes through the volume that change from tile to tile, so that neighbours are near
// each other as on neighbouring rays, and yet the whole volume is met.
#include "volume/sample.glsl"
uniform vec2 u_pixels;
layout(location = 0) out vec4 o_sample;

void main() {
    vec2 tile = floor(gl_FragCoord.xy / 16.0);
    float z = fract(dot(tile, vec2(0.61803399, 0.41421356)));
    vec3 place = 0.1 + 0.8 * vec3(gl_FragCoord.xy / u_pixels, z);
#ifdef GRADIENT
    o_sample = vec4(place, dot(sample_gradient(place), vec3(1.0)));
#else
    o_sample = vec4(place, sample_volume(place));
#endif
}

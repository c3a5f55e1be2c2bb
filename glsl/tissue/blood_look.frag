#version 330 core
#include "tissue/blood_on_ground.glsl"
// What is seen of the blood: its height, its colour, and the slope of its surface.
uniform sampler2D u_relief;  // height [mm], -1 without a surface
uniform sampler2D u_lengths;  // of blood_ground.frag
uniform vec3 u_extinction;  // [1/mm]
uniform vec3 u_deep;        // colour of a layer without end
uniform float u_covering;   // height at which the surface below is hidden to 1 - 1/e [mm]
uniform float u_bump;
layout(location = 0) out float o_height;
layout(location = 1) out vec4 o_colour;
layout(location = 2) out vec4 o_normal;

// A film from which more ran across a seam than has come yet may stand below 0 by a rounding.
const float none = -0.5;

float at(vec2 uv) {
    return textureLod(u_relief, uv, 0.0).r;
}

/// How much the blood falls from low to high in a texel. Of two that are equal it is 0, never -0, as where nothing is drawn.
float fall(float low, float here, float high) {
    float difference = (low < none ? here : low) - (high < none ? here : high);
    return min(low, high) < none ? difference : 0.5 * difference;
}

void main() {
    vec2 unit = 1.0 / vec2(textureSize(u_relief, 0));
    vec2 here = gl_FragCoord.xy * unit;
    float centre = at(here);
    float h = max(centre, 0.0);
    vec2 lengths = textureLod(u_lengths, on_ground(ivec2(gl_FragCoord.xy)), 0.0).rg;
    vec2 falls = vec2(fall(at(here - vec2(unit.x, 0.0)), h, at(here + vec2(unit.x, 0.0))),
                      fall(at(here - vec2(0.0, unit.y)), h, at(here + vec2(0.0, unit.y)))) / lengths;
    // Beside charts there is no length to measure a slope by.
    falls = centre >= none ? falls : vec2(0.0);
    o_height = min(h, 60000.0);
    // Without blood exactly 1, as beside it.
    o_colour = vec4(1.0 - (1.0 - u_deep) * (1.0 - exp(-u_extinction * h)), 1.0 - exp(-h / u_covering));
    o_normal = vec4(normalize(vec3(clamp(u_bump * falls, vec2(-100.0), vec2(100.0)), 1.0)), 1.0);
}

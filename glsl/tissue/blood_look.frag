#version 330 core
// What is seen of the blood: its height, its colour, and the slope of its surface.
uniform sampler2D u_relief;  // height [mm], -1 without a surface
uniform sampler2D u_metric;
uniform vec3 u_extinction;  // [1/mm]
uniform vec3 u_deep;        // colour of a layer without end
uniform float u_covering;   // height at which the surface below is hidden to 1 - 1/e [mm]
uniform float u_bump;
layout(location = 0) out float o_height;
layout(location = 1) out vec4 o_colour;
layout(location = 2) out vec4 o_normal;

float at(ivec2 texel) {
    return texelFetch(u_relief, texel, 0).r;
}

float slope(float low, float here, float high) {
    float difference = (high < 0.0 ? here : high) - (low < 0.0 ? here : low);
    return min(low, high) < 0.0 ? difference : 0.5 * difference;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(u_relief, 0) - 1;
    ivec2 low = max(here - 1, ivec2(0));
    ivec2 high = min(here + 1, last);
    float centre = at(here);
    float h = max(centre, 0.0);
    vec2 lengths = max(texelFetch(u_metric, here, 0).xy, vec2(1e-12));
    vec2 slopes = vec2(slope(at(ivec2(low.x, here.y)), h, at(ivec2(high.x, here.y))),
                       slope(at(ivec2(here.x, low.y)), h, at(ivec2(here.x, high.y)))) / lengths;
    // Beside charts there is no length to measure a slope by.
    slopes = centre >= 0.0 ? slopes : vec2(0.0);
    o_height = min(h, 60000.0);
    // Without blood exactly 1, as beside it.
    o_colour = vec4(1.0 - (1.0 - u_deep) * (1.0 - exp(-u_extinction * h)), 1.0 - exp(-h / u_covering));
    o_normal = vec4(normalize(vec3(-clamp(u_bump * slopes, vec2(-100.0), vec2(100.0)), 1.0)), 1.0);
}

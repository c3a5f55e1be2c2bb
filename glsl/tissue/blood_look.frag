#version 330 core
// What is seen of the blood: its height, its colour, and the slope of its surface.
uniform sampler2D u_film;
uniform sampler2D u_metric;
#ifdef CAPS
uniform sampler2D u_caps;
#endif
uniform vec3 u_extinction;  // [1/mm]
uniform vec3 u_deep;        // colour of a layer without end
uniform float u_covering;   // height at which the surface below is hidden to 1 - 1/e [mm]
uniform float u_bump;
layout(location = 0) out float o_height;
layout(location = 1) out vec4 o_colour;
layout(location = 2) out vec4 o_normal;

vec2 at(ivec2 texel) {
    vec4 film = texelFetch(u_film, texel, 0);
    float height = film.x + film.y;
#ifdef CAPS
    height += texelFetch(u_caps, texel, 0).r;
#endif
    return vec2(max(height, 0.0), film.w == 0.0 ? 0.0 : 1.0);
}

float slope(vec2 low, float here, vec2 high) {
    float both = low.y * high.y;
    float difference = (high.y > 0.0 ? high.x : here) - (low.y > 0.0 ? low.x : here);
    return both > 0.0 ? 0.5 * difference : difference;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(u_film, 0) - 1;
    ivec2 low = max(here - 1, ivec2(0));
    ivec2 high = min(here + 1, last);
    vec2 centre = at(here);
    float h = centre.x;
    vec2 lengths = max(texelFetch(u_metric, here, 0).xy, vec2(1e-12));
    vec2 slopes = vec2(slope(at(ivec2(low.x, here.y)), h, at(ivec2(high.x, here.y))),
                       slope(at(ivec2(here.x, low.y)), h, at(ivec2(here.x, high.y)))) / lengths;
    // Beside charts there is no length to measure a slope by.
    slopes = centre.y > 0.0 ? slopes : vec2(0.0);
    o_height = min(h, 60000.0);
    o_colour = vec4(u_deep + (1.0 - u_deep) * exp(-u_extinction * h), 1.0 - exp(-h / u_covering));
    o_normal = vec4(normalize(vec3(-clamp(u_bump * slopes, vec2(-100.0), vec2(100.0)), 1.0)), 1.0);
}

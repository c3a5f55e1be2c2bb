#version 330 core
#include "common/texel.glsl"
// Joins the vessels with the cloud at the injection point: effects/contrast/summarize_curve.h.
uniform sampler2D u_main;
uniform sampler2D u_cloud;
layout(location = 0) out float o_summary;

const float half_width = 0.05;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float main_value = texel_at(u_main, pixel).r;
    vec2 cloud = texel_at(u_cloud, pixel).rg;
    float r = mix(main_value, cloud.r, cloud.g);
#ifdef DENSEST
    o_summary = max(main_value, r);
#else
    float joined = 0.5 * (r + main_value);
    float excess = 0.9 * main_value - r;
#ifdef THESIS_TRANSITION
    float weight = excess > 0.0 ? 1.0 : 0.0;
#else
    float weight = smoothstep(-half_width, half_width, excess);
#endif
    o_summary = cloud.g > 0.0 ? mix(r, joined, weight) : main_value;
#endif
}

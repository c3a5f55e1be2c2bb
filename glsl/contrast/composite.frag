#version 330 core
#include "common/texel.glsl"
// What the detector shows: the densest of all contrast darkens the background.
uniform float u_background_level;
#ifdef BACKGROUND
uniform sampler2D u_background;
#endif
#ifdef SUMMARY
uniform sampler2D u_summary;
#endif
#ifdef REFLUX
uniform sampler2D u_reflux;
#endif
#ifdef EXTRAVASATE
uniform sampler2D u_extravasate;
#endif
#ifdef CAPILLARY
uniform sampler2D u_capillary;
in vec2 v_uv;
#endif
uniform float u_attenuation;  // log2 of the transmission at ratio 1
layout(location = 0) out float o_final;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float ratio = 0.0;
#ifdef SUMMARY
    ratio = max(ratio, texel_at(u_summary, pixel).r);
#endif
#ifdef REFLUX
    ratio = max(ratio, texel_at(u_reflux, pixel).r);
#endif
#ifdef EXTRAVASATE
    ratio = max(ratio, texel_at(u_extravasate, pixel).r);
#endif
#ifdef CAPILLARY
    // Blurred, so that it may be kept at a lower resolution.
    ratio = max(ratio, textureLod(u_capillary, v_uv, 0.0).r);
#endif
#ifdef BACKGROUND
    float background = texel_at(u_background, pixel).r;
#else
    float background = u_background_level;
#endif
#ifdef THESIS_TONE
    o_final = ratio < 0.5 ? mix(background, 0.1, 2.0 * ratio) : 0.15 * ratio;
#else
    o_final = background * exp2(u_attenuation * ratio);
#endif
}

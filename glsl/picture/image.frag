#version 330 core
// A picture file brought to the target's size.
uniform sampler2D u_image;
uniform vec2 u_scale;   // target uv to image uv
uniform vec2 u_offset;
uniform float u_gain;
in vec2 v_uv;
#ifdef MONOCHROME
layout(location = 0) out float o_color;
#else
layout(location = 0) out vec4 o_color;
#endif

const float largest = 65504.0;  // of half floats: beyond it some drivers store infinity

void main() {
    vec2 uv = v_uv * u_scale + u_offset;
    bool inside = all(greaterThanEqual(uv, vec2(0.0))) && all(lessThanEqual(uv, vec2(1.0)));
    vec4 texel = inside ? textureLod(u_image, uv, 0.0) : vec4(0.0, 0.0, 0.0, 1.0);
#ifdef MONOCHROME
    o_color = clamp(u_gain * texel.r, -largest, largest);
#else
    o_color = clamp(vec4(u_gain * texel.rgb, texel.a), -largest, largest);
#endif
}

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

void main() {
    vec4 texel = textureLod(u_image, v_uv * u_scale + u_offset, 0.0);
#ifdef MONOCHROME
    o_color = u_gain * texel.r;
#else
    o_color = vec4(u_gain * texel.rgb, texel.a);
#endif
}

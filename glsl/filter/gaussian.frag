#version 330 core
// One direction of a separable Gaussian. Neighbouring weights are merged in pairs into one linear fetch each where the hardware's
// filter is precise enough for a blur; the weights are made on the CPU and sum to 1 with the centre.
uniform sampler2D u_source;
uniform vec2 u_direction;    // one source texel along the axis, in texture coordinates
uniform float u_centre;      // weight of the pixel itself
uniform vec2 u_taps[32];     // offset [texels], weight
uniform int u_tap_count;
uniform float u_gain;
in vec2 v_uv;
layout(location = 0) out float o_value;

void main() {
    float sum = u_centre * textureLod(u_source, v_uv, 0.0).r;
    for (int i = 0; i < u_tap_count; ++i) {
        vec2 offset = u_taps[i].x * u_direction;
        sum += u_taps[i].y * (textureLod(u_source, v_uv + offset, 0.0).r + textureLod(u_source, v_uv - offset, 0.0).r);
    }
    o_value = min(u_gain * sum, 1.0);
}

#version 330 core
// One direction of a separable Gaussian. Neighbouring weights are merged in pairs into one linear fetch each where the hardware's
// filter is precise enough for a blur; the weights are made on the CPU and sum to 1 with the centre.
uniform sampler2D u_source;
uniform vec2 u_direction;    // one source texel along the axis, in texture coordinates
uniform float u_centre;      // weight of the pixel itself
#if TAPS > 0
uniform vec2 u_taps[TAPS];   // offset [texels], weight
#endif
uniform float u_gain;
in vec2 v_uv;
layout(location = 0) out float o_value;

void main() {
    float sum = u_centre * textureLod(u_source, v_uv, 0.0).r;
#if TAPS > 0
    // The count is known when this is compiled: compilers unroll up to the array's end otherwise, and software renderers then pay for
    // the taps that are not there.
    for (int i = 0; i < TAPS; ++i) {
        vec2 offset = u_taps[i].x * u_direction;
        sum += u_taps[i].y * (textureLod(u_source, v_uv + offset, 0.0).r + textureLod(u_source, v_uv - offset, 0.0).r);
    }
#endif
    o_value = min(u_gain * sum, 1.0);
}

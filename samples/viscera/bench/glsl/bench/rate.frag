#version 330 core
// Many of one operation, hardly anything else.
const int steps = 32;
in vec2 v_uv;
layout(location = 0) out vec4 o_value;
#ifdef EXP
void main() {
    float x = v_uv.x;
    for (int i = 0; i < steps; ++i) {
        x = exp(-x);
    }
    o_value = vec4(x);
}
#else
uniform sampler2D u_a;
void main() {
    vec4 sum = vec4(0.0);
    vec2 texel = 1.0 / vec2(textureSize(u_a, 0));
    for (int i = 0; i < steps; ++i) {
        sum += textureLod(u_a, v_uv + float(i) * 0.37 * texel, 0.0);
    }
    o_value = sum / float(steps);
}
#endif

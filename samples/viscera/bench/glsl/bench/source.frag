#version 330 core
// Waves in [0, 1], different in each channel and for each amount, as input for what is measured.
uniform float u_amount;
layout(location = 0) out vec4 o_value;

void main() {
    vec4 phase = vec4(0.031, 0.047, 0.017, 0.023) * gl_FragCoord.x + vec4(0.013, -0.019, 0.037, 0.029) * gl_FragCoord.y;
    o_value = 0.5 + 0.5 * sin(phase + u_amount);
}

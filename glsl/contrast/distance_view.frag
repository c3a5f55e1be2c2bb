#version 330 core
// The distance map for the eye: cyan near the injection point, green on the rest of the vessels, black beside them.
uniform sampler2D u_distance;
layout(location = 0) out vec4 o_color;

void main() {
    float q = texelFetch(u_distance, ivec2(gl_FragCoord.xy), 0).r;
    o_color = q < 0.0 ? vec4(0.0, 0.0, 0.0, 1.0) : vec4(0.0, 1.0, q, 1.0);
}

#version 330 core
uniform vec3 u_colour;
#ifdef DEPTH
uniform sampler2D u_depth;
#endif
in vec2 v_across;
flat in float v_stretch;
layout(location = 0) out vec4 o_colour;  // premultiplied

void main() {
    // A capsule: round ends beyond the streak's own length.
    vec2 from_axis = vec2(v_across.x, max(abs(v_across.y) - v_stretch, 0.0));
    float inside = 1.0 - dot(from_axis, from_axis);
    bool hidden = inside <= 0.0;
#ifdef DEPTH
    hidden = hidden || gl_FragCoord.z > texelFetch(u_depth, ivec2(gl_FragCoord.xy), 0).r;
#endif
    if (hidden) {
        discard;
    }
    float facing = sqrt(inside);
    float gleam = pow(clamp(0.95 * facing - 0.31 * v_across.x, 0.0, 1.0), 24.0);
    float opacity = smoothstep(0.0, 0.4, inside);
    o_colour = opacity * vec4(u_colour * (0.35 + 0.65 * facing) + 0.2 * gleam, 1.0);
}

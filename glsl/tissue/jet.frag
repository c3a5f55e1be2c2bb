#version 330 core
uniform vec3 u_colour;
#ifdef DEPTH
uniform sampler2D u_depth;
#endif
in vec2 v_across;
flat in float v_stretch;
flat in float v_pixel;
flat in float v_cover;
layout(location = 0) out vec4 o_colour;  // premultiplied

void main() {
    // A capsule: round ends beyond the streak's own length.
    vec2 from_axis = vec2(v_across.x, max(abs(v_across.y) - v_stretch, 0.0));
    float away = length(from_axis);
    float opacity = v_cover * clamp((1.0 - away) / max(v_pixel, 1e-6) + 0.5, 0.0, 1.0);
    bool hidden = opacity <= 0.0;
#ifdef DEPTH
    hidden = hidden || gl_FragCoord.z > texelFetch(u_depth, ivec2(gl_FragCoord.xy), 0).r;
#endif
    if (hidden) {
        discard;
    }
    float facing = sqrt(max(1.0 - away * away, 0.0));
    float gleam = pow(clamp(0.95 * facing - 0.31 * v_across.x, 0.0, 1.0), 24.0);
    // A streak of a pixel or less shows both only in the mean across it; single samples would be beads.
    float unresolved = clamp(v_pixel, 0.0, 1.0);
    facing = mix(facing, 0.785, unresolved);
    gleam = mix(gleam, 0.24, unresolved);
    o_colour = opacity * vec4(u_colour * (0.35 + 0.65 * facing) + 0.2 * gleam, 1.0);
}

#version 330 core
uniform vec3 u_colour;
#ifdef DEPTH
uniform sampler2D u_depth;
#endif
in vec2 v_across;
flat in float v_stretch;
flat in float v_blur;
flat in float v_pixel;
flat in float v_cover;
flat in float v_round;
layout(location = 0) out vec4 o_colour;  // premultiplied

/// Integral from the middle to a place along the axis of how far the surface faces the viewer. half_width: of the surface there.
float facing_until(float y, float half_width) {
    float past = min(max(abs(y) - v_stretch, 0.0), half_width);
    float ball = 0.5 * (past * sqrt(max(half_width * half_width - past * past, 0.0)) +
                        half_width * half_width * asin(min(past / max(half_width, 1e-6), 1.0)));
    return sign(y) * (half_width * min(abs(y), v_stretch) + ball);
}

void main() {
    // A capsule: round ends beyond its own length. Its blur along its way is the time that it spends at a place.
    vec2 at = abs(v_across);
    float half_width = sqrt(max(1.0 - at.x * at.x, 0.0));
    float end = v_stretch + half_width;
    float first = max(at.y - v_blur, -end);
    float last = min(at.y + v_blur, end);
    float spent = max(last - first, 0.0);
    float opacity = v_cover * clamp((1.0 - at.x) / max(v_pixel, 1e-6) + 0.5, 0.0, 1.0) * min(spent / (2.0 * v_blur), 1.0);
    bool hidden = opacity <= 0.0;
#ifdef DEPTH
    hidden = hidden || gl_FragCoord.z > texelFetch(u_depth, ivec2(gl_FragCoord.xy), 0).r;
#endif
    if (hidden) {
        discard;
    }
    float facing = (facing_until(last, half_width) - facing_until(first, half_width)) / max(spent, 1e-6);
    float gleam = pow(clamp(0.95 * facing - 0.31 * v_across.x, 0.0, 1.0), 24.0);
    // What is a pixel or less shows only its mean over all, which is another for a cylinder than for a ball; single samples would be beads.
    float unresolved = clamp(v_pixel, 0.0, 1.0);
    facing = mix(facing, mix(0.785, 0.667, v_round), unresolved);
    gleam = mix(gleam, mix(0.232, 0.072, v_round), unresolved);
    o_colour = opacity * vec4(u_colour * (0.35 + 0.65 * facing) + 0.2 * gleam, 1.0);
}

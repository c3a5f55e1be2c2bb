#version 330 core
// Smoke that leaves a vessel: one quad per emitter, no larger than its own smoke. Brightness is the same all over a sprite, so it is
// found here, once per corner, and a sprite of no brightness shrinks to nothing.
const int batch = 16;
uniform vec4 u_rect[batch];      // target uv: low, high
uniform vec3 u_source[batch];    // target uv of the base, strength
uniform sampler2D u_summary;
flat out int v_emitter;
flat out float v_brightness;

float brightest_around(vec2 base) {
    float brightest = textureLod(u_summary, base, 0.0).r;
    for (int ring = 1; ring <= 4; ++ring) {
        float step_uv = 0.01 * float(ring);
        brightest = max(brightest, textureLod(u_summary, base - vec2(step_uv, 0.0), 0.0).r);
        brightest = max(brightest, textureLod(u_summary, base + vec2(step_uv, 0.0), 0.0).r);
        brightest = max(brightest, textureLod(u_summary, base - vec2(0.0, step_uv), 0.0).r);
        brightest = max(brightest, textureLod(u_summary, base + vec2(0.0, step_uv), 0.0).r);
    }
    return brightest;
}

void main() {
    v_emitter = gl_InstanceID;
    vec3 source = u_source[gl_InstanceID];
    v_brightness = source.z * brightest_around(source.xy);
    vec4 rect = u_rect[gl_InstanceID];
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
    vec2 uv = v_brightness > 0.0 ? mix(rect.xy, rect.zw, corner) : vec2(-1.0);
    gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);
}

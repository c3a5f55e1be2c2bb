#version 330 core
const int batch = 16;
uniform vec4 u_base[batch];   // pixels: whole part, fraction
uniform vec4 u_tip[batch];    // pixels: whole part, fraction
uniform vec4 u_axis[batch];   // unit vector from base to tip, 1 / (size L), 1 / (0.3 L); lengths in pixels
uniform vec3 u_view[batch];   // layer of the views, 1 / width of the front view [1/pixels], its weight
uniform sampler3D u_views;
flat in int v_emitter;
flat in float v_brightness;
#ifdef FRONT
uniform sampler2D u_front;
#endif
#ifdef MASK
uniform sampler2D u_mask_sharp;
uniform sampler2D u_mask_blurred;
uniform vec2 u_inv_size;  // of the target [1/pixels]

float mask_at(sampler2D mask, bool same_size) {
    return same_size ? texelFetch(mask, ivec2(gl_FragCoord.xy), 0).r : textureLod(mask, gl_FragCoord.xy * u_inv_size, 0.0).r;
}
uniform bool u_sharp_same_size;
uniform bool u_blurred_same_size;
#endif
layout(location = 0) out float o_smoke;

bool inside(vec2 uv) {
    return all(greaterThanEqual(uv, vec2(0.0))) && all(lessThanEqual(uv, vec2(1.0)));
}

void main() {
    vec4 axis = u_axis[v_emitter];
    vec3 view = u_view[v_emitter];
    // Whole pixels are subtracted first, which is exact: near the base the difference keeps all its digits.
    vec4 base = u_base[v_emitter];
    vec2 d = (gl_FragCoord.xy - base.xy) - base.zw;
    vec2 side = vec2(axis.y * d.x - axis.x * d.y, axis.x * d.x + axis.y * d.y) * axis.z + vec2(0.55, 0.15);
    float smoke = inside(side) ? textureLod(u_views, vec3(side, view.x), 0.0).r : 0.0;
#ifdef FRONT
    vec4 tip = u_tip[v_emitter];
    vec2 front = ((gl_FragCoord.xy - tip.xy) - tip.zw) * view.y + 0.5;
    smoke += inside(front) ? view.z * textureLod(u_front, front, 0.0).r : 0.0;
#endif
#ifdef MASK
    smoke *= mix(mask_at(u_mask_sharp, u_sharp_same_size), mask_at(u_mask_blurred, u_blurred_same_size),
                 clamp(length(d) * axis.w, 0.0, 1.0));
#endif
    o_smoke = clamp(2.0 * smoke * v_brightness, 0.0, 1.0);
}

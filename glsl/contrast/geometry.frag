#version 330 core
// Any of the three pictures of the vessel surface, one output each: MAIN, CLOUD, DISTANCE. All combine by maximum, so the order of
// triangles does not matter. With DEPTH the depth test keeps the densest fragment instead.
#ifdef MAIN
#ifdef ARRIVAL
#include "contrast/bolus.glsl"
#endif
#include "contrast/opacity.glsl"
in float v_scalar;
#ifdef CALIBRE
in float v_weight;
#endif
#ifdef THICKNESS
in float v_half_way;
uniform float u_inv_calibre;  // 1 / the way on which the density shows in full [1/mm]
#endif
uniform float u_tone;
layout(location = MAIN) out float o_main;
#endif

#ifdef INJECTION
in vec3 v_from_injection;  // [mm]
uniform float u_inv_radius;  // [1/mm]; 0 for a cloud without extent
uniform float u_brightness;
uniform float u_threshold;

// 1 up to two thirds of the radius, then down to 0 at the radius.
float closeness() {
    return u_inv_radius > 0.0 ? clamp(3.0 - 3.0 * length(v_from_injection) * u_inv_radius, 0.0, 1.0) : 0.0;
}
#endif
#ifdef CLOUD
layout(location = CLOUD) out vec2 o_cloud;  // brightness c, weight q
#endif
#ifdef DISTANCE
layout(location = DISTANCE) out float o_distance;  // q on the vessel; the target is cleared to -1
#endif

void main() {
#ifdef MAIN
#ifdef ARRIVAL
    float density = bolus(v_scalar);
#ifdef CALIBRE
    density *= clamp(v_weight, 0.0, 1.0);
#endif
#else
    float density = clamp(v_scalar, 0.0, 1.0);
#endif
    o_main = u_tone * density * contrast_opacity(density);
#ifdef THICKNESS
    // Nothing shines through so much, and hundreds of such walls add up to a number that a half float holds.
    const float opaque = 64.0;
    o_main *= abs(v_half_way) * u_inv_calibre;
    o_main = o_main >= 0.0 ? min(o_main, opaque) : 0.0;  // 0 where it is no number
#endif
#ifdef DEPTH
    // The density itself with a GREATER test, not 1 - density with LESS: near 0 a float keeps the small differences that
    // the subtraction would round away, so this gives the very picture of the maximum.
    gl_FragDepth = density;
#endif
#endif
#ifdef INJECTION
    float q = closeness();
#ifdef CLOUD
    float c = u_brightness * q;
    // Dropped by writing what the target is cleared to: a discard would drop the other outputs, too.
    o_cloud = c < u_threshold ? vec2(0.0) : vec2(c, q);
#endif
#ifdef DISTANCE
    o_distance = q;
#endif
#endif
}

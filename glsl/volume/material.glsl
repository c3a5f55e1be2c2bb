// What a place in the volume looks like: colour as it is seen and extinction [1/mm]. What a scene does not use is not
// compiled: effects/volume/look.h.
#ifdef LABELS
#include "volume/labels.glsl"
#endif
#ifdef OVERLAY
#include "volume/overlay.glsl"
#endif
#ifdef GRADIENT_OPACITY
#include "volume/gradient_opacity.glsl"
#endif
#ifdef SHADING
#include "volume/shading.glsl"
#endif
#ifdef LIGHT_VOLUME
uniform sampler3D u_light_volume;        // share of the first light and of the ambient light that arrives
uniform mat4 u_light_volume_from_local;  // local -> its texture coordinates
#endif

vec3 view_direction;  // of the ray, in the world, of length 1

void look_along(vec3 direction) {
    view_direction = direction;
}

// Colour and extinction as they come to the eye from a place.
vec4 appearance(vec4 c, vec3 local) {
#ifdef OVERLAY
    c.rgb = overlaid(c.rgb, local);
#endif
#if defined(GRADIENT_OPACITY) || defined(SHADING)
    vec3 gradient = metric(sample_gradient(to_sample(local)), local);
#endif
#ifdef GRADIENT_OPACITY
    c.a = with_gradient_opacity(c.a, length(gradient));
#endif
#ifdef LIGHT_VOLUME
    vec2 arrives = textureLod(u_light_volume, (u_light_volume_from_local * vec4(local, 1.0)).xyz, 0.0).rg;
#else
    const vec2 arrives = vec2(1.0);
#endif
#ifdef SHADING
    c.rgb = shaded(c.rgb, gradient, local, view_direction, arrives);
#elif defined(LIGHT_VOLUME)
    c.rgb *= min(arrives.x, arrives.y);
#endif
    return c;
}

vec4 material(vec3 local) {
#if defined(COLOURS)
    vec4 c = colour_material(to_sample(local));
#ifdef LABELS
    c = labelled(c, label_at(local));
#endif
#elif defined(LABELS)
    vec4 c = classify_label(sample_volume(to_sample(local)), label_at(local));
#else
    vec4 c = classify(sample_volume(to_sample(local)));
#endif
    return appearance(c, local);
}

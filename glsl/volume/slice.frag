#version 330 core
// A volume's values on a plane, which fills the picture or is drawn as a surface (CAMERA), or on a mesh.
// SLAB: 0 mean, 1 greatest, 2 least value across the slice's thickness.
#ifdef COORDINATES
#include "volume/curvilinear.glsl"
#if COORDINATES == 1
#include "volume/place_cylindrical.glsl"
#else
#include "volume/place_spherical.glsl"
#endif
#endif
#include "volume/sample.glsl"
#include "volume/classify.glsl"
uniform int u_slab_samples;
uniform vec3 u_slab_extent;  // across the slab, in local coordinates: those of the texture, unless it is curvilinear
#ifdef CAMERA
in vec3 v_local;
#else
uniform vec3 u_point[3];    // in local coordinates: in the picture's centre, per NDC x, per NDC y
uniform vec2 u_pixel;       // size of a pixel in normalised device coordinates
uniform vec4 u_background;  // premultiplied
#endif
layout(location = 0) out vec4 o_colour;

// Faces belong to the volume, whatever rounding says.
bool inside_box(vec3 place) {
    return all(greaterThanEqual(place, vec3(-1e-6))) && all(lessThanEqual(place, vec3(1.0 + 1e-6)));
}

// What the part of the slab that lies in the volume comes to, and in y how many samples that are.
vec2 across_slab(vec3 middle) {
#if SLAB == 1
    float value = -3e38;
#elif SLAB == 2
    float value = 3e38;
#else
    float value = 0.0;
#endif
    float count = 0.0;
    for (int i = 0; i < u_slab_samples; ++i) {
        float share = (float(i) + 0.5) / float(u_slab_samples) - 0.5;
        vec3 place = middle + share * u_slab_extent;
#ifdef COORDINATES
        place = to_sample(place);
        bool counts = all(greaterThanEqual(place, u_sample_low)) && all(lessThanEqual(place, u_sample_high));
#else
        bool counts = inside_box(place);
#endif
        float here = sample_volume(place);
        count += counts ? 1.0 : 0.0;
#if SLAB == 1
        value = counts ? max(value, here) : value;
#elif SLAB == 2
        value = counts ? min(value, here) : value;
#else
        value += counts ? here : 0.0;
#endif
    }
#if SLAB == 0
    value /= max(count, 1.0);
#endif
    return vec2(value, count);
}

void main() {
#ifdef CAMERA
    vec2 found = across_slab(v_local);
    if (found.y == 0.0) {
        discard;
    }
    o_colour = vec4(classify(found.x).rgb, 1.0);
#else
    vec2 ndc = gl_FragCoord.xy * u_pixel - 1.0;
    vec2 found = across_slab(u_point[0] + ndc.x * u_point[1] + ndc.y * u_point[2]);
    o_colour = found.y > 0.0 ? vec4(classify(found.x).rgb, 1.0) : u_background;
#endif
}

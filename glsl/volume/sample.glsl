// The volume between its voxels, by the reconstruction filter of effects/volume/reconstruction.h (none defined: linear).
// `place` in texture coordinates: voxel i's centre lies at (i + 1/2) / n; beyond the outermost centres the outermost
// voxels go on.
#include "volume/storage.glsl"
#if defined(FILTER_BSPLINE) || defined(FILTER_BSPLINE_FP32)
#define CUBIC_BSPLINE
#endif
#if defined(CUBIC_BSPLINE) || defined(FILTER_CATMULL_ROM) || defined(FILTER_CATMULL_ROM_FP32)
#include "volume/cubic_weights.glsl"
#include "volume/cubic_jet.glsl"
#endif
#if defined(FILTER_NEAREST)
#include "volume/filter_nearest.glsl"
#elif defined(FILTER_LINEAR_FP32)
#include "volume/filter_linear_fp32.glsl"
#elif defined(FILTER_BSPLINE)
#include "volume/filter_bspline.glsl"
#elif defined(FILTER_CATMULL_ROM)
#include "volume/filter_catmull_rom.glsl"
#elif defined(FILTER_BSPLINE_FP32) || defined(FILTER_CATMULL_ROM_FP32)
#include "volume/filter_cubic_fp32.glsl"
#else
#include "volume/filter_linear.glsl"
#endif
#ifdef COLOURS
float sample_volume(vec3 place) {
    return sample_colour(place).a;
}
#endif

#if defined(GRADIENT_KEPT) && !defined(STORAGE_ATLAS)
uniform sampler3D u_gradients;   // central differences at the voxels: effects/volume/gradients.h
uniform vec3 u_gradient_scale;   // of a texel -> per texture coordinate

// Beyond the outermost centres the values go on, so that one of the two that a difference is taken of stays behind: it
// falls to half at the face. The texture's own edge would go on with all of it.
vec3 share_of_difference(vec3 place) {
    vec3 size = vec3(volume_size());
    vec3 p = place * size;
    vec3 beyond = clamp(max(0.5 - p, p - (size - 0.5)), 0.0, 1.0);
#ifdef COORDINATES
    beyond.ANGLE = u_ring ? 0.0 : beyond.ANGLE;
#endif
    return 1.0 - beyond;
}
#endif

// Derivative of the value per texture coordinate: the filter's own, or the central difference of one voxel to either
// side (GRADIENT_CENTRAL). That of the trilinear filter is the trilinear mix of the differences at the voxels, so it can be
// looked up where they are kept (GRADIENT_KEPT).
vec3 sample_gradient(vec3 place) {
#if defined(GRADIENT_KEPT) && !defined(STORAGE_ATLAS)
    return u_gradient_scale * share_of_difference(place) * textureLod(u_gradients, within_texture(place), 0.0).rgb;
#elif defined(GRADIENT_CENTRAL)
    vec3 size = vec3(volume_size());
    vec3 x = vec3(1.0 / size.x, 0.0, 0.0);
    vec3 y = vec3(0.0, 1.0 / size.y, 0.0);
    vec3 z = vec3(0.0, 0.0, 1.0 / size.z);
    return 0.5 * size *
           vec3(sample_volume(place + x) - sample_volume(place - x), sample_volume(place + y) - sample_volume(place - y),
                sample_volume(place + z) - sample_volume(place - z));
#else
    return filter_gradient(place);
#endif
}

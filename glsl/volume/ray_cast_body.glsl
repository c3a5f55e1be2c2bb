// The whole of ray casting for one pixel, shared by the fragment and the compute path. What stands for each part is the
// variant's: effects/volume/ray_cast_programs.cpp.
#define MIDPOINT 0
#define GAUSS 1
#define PREINTEGRATED 2
#define CELL 3
#include "volume/ray.glsl"
#ifdef COORDINATES
#include "volume/curvilinear.glsl"
#include "volume/curvilinear_limits.glsl"
#if COORDINATES == 1
#include "volume/coordinates_cylindrical.glsl"
#else
#include "volume/coordinates_spherical.glsl"
#endif
#else
#include "volume/coordinates_cartesian.glsl"
#endif
#include "volume/sample.glsl"
#ifdef COLOURS
#include "volume/colours.glsl"
#endif
#include "volume/classify.glsl"
#include "volume/material.glsl"
#if SCHEME == PREINTEGRATED && defined(COMPOSITE)
#include "volume/slab_table.glsl"
#endif
#include "volume/slab.glsl"
#if defined(ISOSURFACE) || (defined(PROJECTION) && SCHEME == CELL)
#include "volume/cell_cubic.glsl"
#endif
#if defined(COMPOSITE)
#include "volume/function_composite.glsl"
#elif defined(ISOSURFACE)
#include "volume/function_isosurface.glsl"
#else
#include "volume/function_projection.glsl"
#endif
#ifdef SKIP
#ifdef COORDINATES
#include "volume/skip_curvilinear.glsl"
#else
#include "volume/skip.glsl"
#endif
#endif
#if (SCHEME == CELL || defined(ISOSURFACE)) && !defined(COORDINATES)
#include "volume/march_cells.glsl"
#else
#include "volume/march.glsl"
#endif
#if defined(FOVEA) && !defined(ISOSURFACE)
#include "volume/fovea.glsl"
#endif
#ifdef JITTER
#include "volume/jitter.glsl"
#endif
#include "volume/picture.glsl"
#ifdef MIXED_COARSE
#include "volume/mixed_lattice.glsl"
#endif
#ifdef MIXED_FINE
#include "volume/mixed_choice.glsl"
#endif
#ifdef LIMITS
#include "volume/limits.glsl"
#endif
#ifdef CLIP
#include "volume/clip.glsl"
#endif

#ifdef SUB_VOLUME
uniform float u_sub_volume_depth;  // [mm]
#endif

vec4 cast_ray(vec2 pixel) {
#ifdef MIXED_COARSE
    pixel = lattice_pixel(pixel);
#endif
    Ray ray = pixel_ray(pixel);
#ifdef SURFACE
    ray.far = min(ray.far, surface_along(ray, pixel));
#endif
#if defined(FOVEA) && !defined(ISOSURFACE)
    slab_mm = u_slab * fovea_factor(pixel);
#endif
    look_along(ray.world);
    State state = begin();
    bool met = false;
#if defined(JITTER) && !defined(ISOSURFACE)
    float offset = jitter(ivec2(pixel));
#else
    const float offset = 0.0;
#endif
#ifdef SUB_VOLUME
    float sub_volume_end = 3e38;
#endif
#ifdef LIMITS
    // Both are in order along the ray, so their common parts are, too.
    vec2 piece = vec2(0.0);
    for (int i = 0; i < max_intervals * max_passages; ++i) {
        int passage = i % max_passages;
        piece = passage == 0 ? ray_interval(ray, i / max_passages) : piece;
        vec2 interval = limit_interval(ray, pixel, piece, passage);
#else
    for (int i = 0; i < max_intervals; ++i) {
        vec2 interval = ray_interval(ray, i);
#endif
#ifdef CLIP
        interval = clip_interval(ray, interval);
#endif
        interval = vec2(max(interval.x, ray.near), min(interval.y, ray.far));
#ifdef SUB_VOLUME
        bool starts = sub_volume_end == 3e38 && interval.x < interval.y;
        sub_volume_end = starts ? interval.x + u_sub_volume_depth : sub_volume_end;
        interval.y = min(interval.y, sub_volume_end);
#endif
        met = met || interval.x < interval.y;
        march(ray, interval, offset, state);
    }
    // What misses the volume is left as it was, also where an X-ray would say that nothing was absorbed.
    vec4 seen = met ? finish(state) : vec4(0.0);
#ifdef BACKGROUND
    return over_background(seen, pixel);
#else
    return seen;
#endif
}

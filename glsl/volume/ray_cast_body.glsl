// The whole of ray casting for one pixel, shared by the fragment and the compute path. What stands for each part is the
// variant's: effects/volume/ray_cast_programs.h.
#include "volume/ray.glsl"
#include "volume/coordinates_cartesian.glsl"
#include "volume/sample.glsl"
#include "volume/classify.glsl"
#include "volume/material.glsl"
#include "volume/slab.glsl"
#ifdef COMPOSITE
#include "volume/function_composite.glsl"
#else
#include "volume/function_projection.glsl"
#endif
#include "volume/march.glsl"

vec4 cast_ray(vec2 pixel) {
    Ray ray = pixel_ray(pixel);
    State state = begin();
    for (int i = 0; i < max_intervals; ++i) {
        vec2 interval = ray_interval(ray, i);
        interval = vec2(max(interval.x, ray.near), min(interval.y, ray.far));
        march(ray, interval, 0.0, state);
    }
    return finish(state);
}

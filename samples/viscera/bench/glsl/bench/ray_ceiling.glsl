// The least that so many samples cost: the ray caster's rays and places, and a sum of what the texture unit gives.
#include "volume/ray.glsl"
#include "volume/coordinates_cartesian.glsl"
#include "volume/storage.glsl"
uniform float u_slab;  // [mm]
uniform int u_slab_limit;

vec4 sum_ray(vec2 pixel) {
    Ray ray = pixel_ray(pixel);
    vec2 interval = ray_interval(ray, 0);
    interval = vec2(max(interval.x, ray.near), min(interval.y, ray.far));
    float slabs = min((interval.y - interval.x) / u_slab, float(u_slab_limit));
    vec3 first = ray.origin + interval.x * ray.direction;
    vec3 extent = ray.direction * u_slab;
    int count = int(ceil(slabs));
    vec3 place = first + 0.5 * extent;
    float sum = 0.0;
    for (int k = 0; k < count; ++k) {
        sum += linear_texel(place);
        place += extent;
    }
    return vec4(sum / max(slabs, 1.0));
}

// Walks one interval of a ray in slabs of u_slab mm that lie on one lattice from the interval's start, so that neither
// skipping nor stopping ever moves a sample. The last slab covers what is left. What happens in a slab is the ray
// function's: bool take_slab(inout State, Slab), true to stop.
// Counters stay below 65,535 in total, where llvmpipe stops loops without a word: effects/volume/sampling.h sees to it.
uniform float u_slab;       // [mm]
uniform int u_slab_limit;

#ifdef SKIP
#include "volume/skip.glsl"
#endif

Slab slab_at(Ray ray, float start, vec3 first, vec3 extent, int k, float slabs, float offset) {
    // Slabs are found from their number, never by adding up: the same slab comes out the same however it was reached.
    float part = min(slabs - float(k), 1.0);
    float middle = float(k) + (0.5 + offset) * part;
    return Slab(first + middle * extent, extent * part, u_slab * part, start + middle * u_slab);
}

void march(Ray ray, vec2 interval, float offset, inout State state) {
    float slabs = min((interval.y - interval.x) / u_slab, float(u_slab_limit));
    if (!(slabs > 0.0)) {
        return;
    }
    int count = int(ceil(slabs));
    vec3 first = ray.origin + interval.x * ray.direction;
    vec3 extent = ray.direction * u_slab;
#ifdef SKIP
    Leaper leaper = make_leaper(first, extent);
    int k = 0;
    while (k < count) {
        int end = count;
        // Leaping and sampling are loops of their own: in one loop every step would pay for both.
        while (k < count) {
            Run run = run_from(leaper, k, count);
            end = run.end;
            if (run.occupied) {
                break;
            }
            k = run.end;
        }
        for (; k < end; ++k) {
            if (take_slab(state, slab_at(ray, interval.x, first, extent, k, slabs, offset))) {
                k = count;
                break;
            }
        }
    }
#else
    for (int k = 0; k < count; ++k) {
        if (take_slab(state, slab_at(ray, interval.x, first, extent, k, slabs, offset))) {
            break;
        }
    }
#endif
}

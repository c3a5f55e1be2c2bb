// Walks one interval of a ray in slabs of slab_mm that lie on one lattice from the interval's start, so that neither
// skipping nor stopping ever moves a sample. The last slab covers what is left. What happens in a slab is the ray
// function's: bool take_slab(inout State, Slab), true to stop.
// Counters stay below 65,535 in total, where llvmpipe stops loops without a word: effects/volume/sampling.h sees to it.
uniform float u_slab;  // [mm]
#ifdef FOVEA
float slab_mm;  // of this ray, whose slabs lie on a lattice of their own: volume/fovea.glsl
#else
#define slab_mm u_slab
#endif
uniform int u_slab_limit;

const int most_joined = 64;  // slabs that are one where the transfer function does not change

// Slabs are found from their number, never by adding up: the same slab comes out the same however it was reached.
Slab slab_at(float start, vec3 first, vec3 extent, int k, float number, float slabs, float offset) {
    float part = min(slabs - float(k), number);
    float middle = float(k) + (0.5 + offset) * part;
    return Slab(first + middle * extent, extent * part, slab_mm * part, start + middle * slab_mm);
}

void march(Ray ray, vec2 interval, float offset, inout State state) {
    float slabs = min((interval.y - interval.x) / slab_mm, float(u_slab_limit));
    if (!(slabs > 0.0)) {
        return;
    }
    int count = int(ceil(slabs));
    vec3 first = ray.origin + interval.x * ray.direction;
    vec3 extent = ray.direction * slab_mm;
#ifdef SKIP
    Leaper leaper = make_leaper(first, extent);
    vec2 span = clamp(occupied_span(leaper), 0.0, float(count));
    int k = max(int(span.x) - 1, 0);
    int last = min(int(span.y) + 1, count);
    while (k < last) {
        // Leaping and sampling are loops of their own: in one loop every step would pay for both. Leaping finds all of the
        // next stretch in which slabs are sampled, from its first brick to its last, since pixels that are computed side by
        // side wait for each other at the end of each loop. Loops end by their condition alone: each `break` is one more
        // mask to keep on software renderers.
        int end = k;
        uint kind = run_empty;
        bool leaping = true;
        while (leaping) {
            // A slab belongs to the brick of its centre, whose range covers the whole slab: its border is that wide. The last
            // slab ends with the interval: the centre of a whole one may lie outside the volume or the crop.
            Run run = run_from(leaper, min(float(end) + 0.5, 0.5 * (float(end) + slabs)));
            bool goes_on = run.kind == kind;
            bool begins = kind == run_empty;
            end = goes_on || begins ? min(end + 1 + int(min(run.extent, float(count))), last) : end;
            k = goes_on && begins ? end : k;
            kind = begins ? run.kind : kind;
            leaping = (goes_on || begins) && end < last;
        }
        while (k < end) {
#ifdef ADAPTIVE
            // Long slabs lie on lattices of their own, so that where a run begins does not move them.
            int level = int(kind) - 1;
            int number = 1;
            for (int joined = 4, i = 1; joined <= most_joined; joined *= 4, ++i) {
                bool fits = level >= i && (k & (joined - 1)) == 0 && k + joined <= end;
                number = fits ? joined : number;
            }
#else
            const int number = 1;
#endif
            bool stop = take_slab(state, slab_at(interval.x, first, extent, k, float(number), slabs, offset));
            k = stop ? count : k + number;
        }
    }
#else
    for (int k = 0; k < count; ++k) {
        bool stop = take_slab(state, slab_at(interval.x, first, extent, k, 1.0, slabs, offset));
        k = stop ? count : k;
    }
#endif
}

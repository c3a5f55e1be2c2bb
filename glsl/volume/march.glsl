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

#ifdef HARDWARE
const int most_at_once = 8;  // slabs
#else
const int most_at_once = 12;
#endif
const int most_joined = 64;  // slabs that are one where the transfer function does not change

// Slabs are found from their number, never by adding up: the same slab comes out the same however it was reached.
Slab slab_at(float start, vec3 first, vec3 extent, int k, float number, float slabs, float offset) {
    float part = min(slabs - float(k), number);
    float middle = float(k) + (0.5 + offset) * part;
    return Slab(first + middle * extent, extent * part, slab_mm * part, start + middle * slab_mm);
}

// A slab belongs to the brick of its centre, whose range covers the whole slab: its border is that wide. The last slab ends
// with the interval: the centre of a whole one may lie outside the volume or the crop.
float middle_of(int k, float slabs) {
    return min(float(k) + 0.5, 0.5 * (float(k) + slabs));
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
    int begin = max(int(span.x) - 1, 0);
    int last = min(int(span.y) + 1, count);
#if defined(HARDWARE) && !defined(ADAPTIVE)
    // Pixels side by side go through the same slabs at the same time, whatever each of them has to see: the texture unit then
    // finds their voxels near each other, and a branch that none of them takes costs nothing.
    int empty_until = begin;
    for (int k = 0; k < last; k += most_at_once) {
        int next = min(k + most_at_once, last);
        int from = max(k, empty_until);
        if (from < next) {
            Run run = run_from(leaper, middle_of(from, slabs));
            from = run.kind == run_empty ? from + 1 + int(min(run.extent, float(count))) : from;
            empty_until = from;
        }
        for (; from < next; ++from) {
            if (take_slab(state, slab_at(interval.x, first, extent, from, 1.0, slabs, offset))) {
                from = last;
                k = last;
            }
        }
    }
#else
    int k = begin;
    int end = k;
    uint kind = run_empty;
    while (k < last) {
        // Leaping and sampling are loops of their own: in one loop every step would pay for both. Leaping finds all of the
        // next stretch in which slabs are sampled, from its first brick to its last, since pixels that are computed side by
        // side wait for each other at the end of each loop. Loops end by their condition alone: each `break` is one more
        // mask to keep on software renderers.
        bool leaping = k >= end;
        kind = leaping ? run_empty : kind;
        while (leaping) {
            Run run = run_from(leaper, middle_of(end, slabs));
            bool goes_on = run.kind == kind;
            bool begins = kind == run_empty;
            end = goes_on || begins ? min(end + 1 + int(min(run.extent, float(count))), last) : end;
            k = goes_on && begins ? end : k;
            kind = begins ? run.kind : kind;
            leaping = (goes_on || begins) && end < last;
        }
        // A few slabs at a time: a pixel with a long stretch then does not keep its neighbours waiting that have several short ones.
        int pause = min(end, k + most_at_once);
        while (k < pause) {
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
#endif
#else
    for (int k = 0; k < count; ++k) {
        bool stop = take_slab(state, slab_at(interval.x, first, extent, k, 1.0, slabs, offset));
        k = stop ? count : k;
    }
#endif
}

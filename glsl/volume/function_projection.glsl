// Extremes, means and line integrals along the ray.
// PROJECTION: 0 maximum, 1 minimum, 2 average, 3 X-ray.
uniform vec2 u_attenuation;     // texel value -> attenuation [1/mm]: x * value + y
uniform float u_threshold;      // iso value: samples below it are dropped
uniform vec2 u_film;            // optical depth that a film begins to show, and share of its range per depth; 0: no film
uniform vec2 u_intensity;       // intensity without and share of brightness turned round: see finish

struct State {
    float value;
    float length_mm;  // that counted
};

State begin() {
#if PROJECTION == 0
    return State(-3e38, 0.0);
#elif PROJECTION == 1
    return State(3e38, 0.0);
#else
    return State(0.0, 0.0);
#endif
}

// Share of a place's attenuation that is seen; what is hidden counts in no projection.
float seen_at(vec3 local) {
#ifdef LABELS
    return factor_of(label_at(local));
#else
    return 1.0;
#endif
}

#if PROJECTION < 2
#if PROJECTION == 0
#define FURTHER max
#else
#define FURTHER min
#endif

// A value as far as an extreme minds it.
float candidate(float value, vec3 local) {
#ifdef LABELS
    return seen_at(local) > 0.0 ? value : begin().value;
#else
    return value;
#endif
}

float candidate_at(vec3 local) {
    return candidate(sample_volume(to_sample(local)), local);
}

// Largest (or least) value in the slab that counts.
float extreme(Slab slab) {
#if SCHEME == CELL
    vec4 cubic = cell_cubic(slab);
    vec2 turns = cubic_turns(cubic);
    vec3 first = slab.centre - 0.5 * slab.extent;
    return FURTHER(FURTHER(candidate(cubic.x, first), candidate(cubic.w, first + slab.extent)),
                   FURTHER(candidate(cubic_value(cubic, turns.x), first + turns.x * slab.extent),
                           candidate(cubic_value(cubic, turns.y), first + turns.y * slab.extent)));
#elif SCHEME == GAUSS
    return FURTHER(candidate_at(slab.centre - 0.25 * slab.extent), candidate_at(slab.centre + 0.25 * slab.extent));
#else
    return candidate_at(slab.centre);
#endif
}
#endif

// Of a value that is there.
bool is_counted(float value) {
#ifdef THRESHOLD
    return value >= u_threshold;
#else
    return true;
#endif
}

void add(inout State state, vec3 local, float length_mm) {
    float value = sample_volume(to_sample(local));
    float seen = seen_at(local);
#if PROJECTION == 3
    state.value += seen * max(value * u_attenuation.x + u_attenuation.y, 0.0) * length_mm;
#else
    bool counts = seen > 0.0 && is_counted(value);
    state.value += counts ? value * length_mm : 0.0;
    state.length_mm += counts ? length_mm : 0.0;
#endif
}

bool take_slab(inout State state, Slab slab) {
#if PROJECTION < 2
    float value = extreme(slab);
#ifdef LABELS
    bool counts = value != begin().value && is_counted(value);
#else
    bool counts = is_counted(value);
#endif
    state.value = counts ? FURTHER(state.value, value) : state.value;
    state.length_mm += counts ? slab.length_mm : 0.0;
#elif SCHEME == MIDPOINT
    add(state, slab.centre, slab.length_mm);
#else
    // Two Gauss points are exact for cubics, and along a ray a trilinear cell is one (spec: accuracy F15).
    add(state, slab.centre - gauss_point * slab.extent, 0.5 * slab.length_mm);
    add(state, slab.centre + gauss_point * slab.extent, 0.5 * slab.length_mm);
#endif
    return false;
}

// Extremes and means go through the transfer function once, without regard to length.
vec4 finish(State state) {
#if PROJECTION == 3
    float through = u_film.y > 0.0 ? 1.0 - clamp((state.value - u_film.x) * u_film.y, 0.0, 1.0) : exp(-state.value);
    float intensity = u_intensity.x * through;
    return vec4(vec3(mix(intensity, u_intensity.x - intensity, u_intensity.y)), 1.0);
#else
#if PROJECTION == 2
    float value = state.value / max(state.length_mm, 1e-30);
#else
    float value = state.value;
#endif
    vec4 c = classify(value);
    return state.length_mm > 0.0 ? vec4(c.rgb * c.a, c.a) : vec4(0.0);
#endif
}

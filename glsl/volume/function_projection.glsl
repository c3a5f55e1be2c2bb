// Extremes, means and line integrals along the ray.
// PROJECTION: 0 maximum, 1 minimum, 2 average, 3 X-ray.
uniform vec2 u_attenuation;     // texel value -> attenuation [1/mm]: x * value + y
uniform float u_threshold;      // iso value: samples below it are dropped
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

#if PROJECTION < 2
// Largest (or least) value in the slab that counts.
float extreme(Slab slab) {
#if PROJECTION == 0
#define FURTHER max
#else
#define FURTHER min
#endif
#if SCHEME == CELL
    vec4 cubic = cell_cubic(slab);
    vec2 turns = cubic_turns(cubic);
    return FURTHER(FURTHER(cubic.x, cubic.w), FURTHER(cubic_value(cubic, turns.x), cubic_value(cubic, turns.y)));
#elif SCHEME == GAUSS
    return FURTHER(sample_volume(to_sample(slab.centre - 0.25 * slab.extent)),
                   sample_volume(to_sample(slab.centre + 0.25 * slab.extent)));
#else
    return sample_volume(to_sample(slab.centre));
#endif
}
#endif

void add(inout State state, float value, float length_mm) {
#if PROJECTION == 3
    state.value += max(value * u_attenuation.x + u_attenuation.y, 0.0) * length_mm;
#else
#ifdef THRESHOLD
    bool counts = value >= u_threshold;
#else
    const bool counts = true;
#endif
    state.value += counts ? value * length_mm : 0.0;
    state.length_mm += counts ? length_mm : 0.0;
#endif
}

bool take_slab(inout State state, Slab slab) {
#if PROJECTION < 2
    float value = extreme(slab);
#ifdef THRESHOLD
    bool counts = value >= u_threshold;
#else
    const bool counts = true;
#endif
    state.value = counts ? FURTHER(state.value, value) : state.value;
    state.length_mm += counts ? slab.length_mm : 0.0;
#elif SCHEME == MIDPOINT
    add(state, sample_volume(to_sample(slab.centre)), slab.length_mm);
#else
    // Two Gauss points are exact for cubics, and along a ray a trilinear cell is one (spec: accuracy F15).
    add(state, sample_volume(to_sample(slab.centre - gauss_point * slab.extent)), 0.5 * slab.length_mm);
    add(state, sample_volume(to_sample(slab.centre + gauss_point * slab.extent)), 0.5 * slab.length_mm);
#endif
    return false;
}

// Extremes and means go through the transfer function once, without regard to length.
vec4 finish(State state) {
#if PROJECTION == 3
    float intensity = u_intensity.x * exp(-state.value);
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

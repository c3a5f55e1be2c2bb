// Extremes, means and line integrals along the ray.
// PROJECTION: 0 maximum, 1 minimum, 2 average, 3 X-ray.
uniform vec2 u_attenuation;     // texel value -> attenuation [1/mm]: x * value + y
uniform float u_threshold;      // iso value: samples below it are dropped
uniform vec2 u_intensity;       // intensity without and share of brightness turned round: see finish

struct State {
    float value;
    float length;  // [mm] that counted
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

bool take_slab(inout State state, Slab slab) {
    float value = sample_volume(to_sample(slab.centre));
#if PROJECTION == 3
    state.value += max(value * u_attenuation.x + u_attenuation.y, 0.0) * slab.length;
#else
#ifdef THRESHOLD
    bool counts = value >= u_threshold;
#else
    const bool counts = true;
#endif
#if PROJECTION == 0
    state.value = counts ? max(state.value, value) : state.value;
#elif PROJECTION == 1
    state.value = counts ? min(state.value, value) : state.value;
#else
    state.value += counts ? value * slab.length : 0.0;
#endif
    state.length += counts ? slab.length : 0.0;
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
    float value = state.value / max(state.length, 1e-30);
#else
    float value = state.value;
#endif
    vec4 c = classify(value);
    return state.length > 0.0 ? vec4(c.rgb * c.a, c.a) : vec4(0.0);
#endif
}

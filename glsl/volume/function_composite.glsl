// Emission and absorption, front to back. The optical depth is summed and the transmittance made from it, instead of
// multiplying what each slab lets through: 1 - exp(-x) would cancel in thin slabs and errors of exp add up over hundreds
// of factors.
uniform float u_depth_limit;  // optical depth behind which nothing counts: -log(early termination)

struct State {
    vec3 colour;          // premultiplied
    float depth;          // optical depth
    float transmittance;  // exp(-depth)
};

State begin() {
    return State(vec3(0.0), 0.0, 1.0);
}

#if SCHEME == PREINTEGRATED
// What lies in a slab's front covers what lies behind it: how far the colour that comes out is off the mean along the
// slab. For a colour that runs straight, by d, through an optical depth t it is d (1/t - 1/(exp(t) - 1) - 1/2); the root below
// is within 1 % of that up to t = 6. Only where extinction is alike at both Gauss points do their colours say anything
// about the slab: at the teeth of a function they do not. Without this, smooth functions came out of second order, up to
// eight times as far off as by single samples.
vec3 front_bias(vec4 a, vec4 b, float extinction, float length_mm) {
    float alike = min(a.a, b.a) / max(max(a.a, b.a), max(extinction, 1e-30));
    float t = extinction * length_mm;
    return 1.7320508075688772 * alike * (b.rgb - a.rgb) * (-0.5 * t * inversesqrt(36.0 + 1.2 * t * t));
}

vec3 colour_of_mean(vec4 mean, vec3 bias) {
    return max(mean.rgb / max(mean.a, 1e-30) + bias, vec3(0.0));
}

#ifdef LABELS
// Opacity of an optical depth, 1 - exp(-t).
float absorbed(float t) {
    return t < 0.1 ? t * (1.0 - t * (0.5 - t * (1.0 / 6.0 - t * (1.0 / 24.0)))) : 1.0 - exp(-t);
}

// Each half of a slab belongs to the segment at its Gauss point, so that a border lies within 0.29 slabs of its place; a
// slab whose points lie in one segment is integrated as a whole. `ahead`, `behind`: values at the points.
vec4 slab_in_segments(Slab slab, float ahead, float behind, float middle, float rise) {
    int first = label_at(slab.centre - gauss_point * slab.extent);
    int second = label_at(slab.centre + gauss_point * slab.extent);
    bool whole = first == second;
    float inner = whole ? rise : 0.0;
    vec4 a = slab_mean(middle - rise, middle + inner, ramp_of(first));
    vec4 b = slab_mean(middle - inner, middle + rise, ramp_of(second));
    float factor = factor_of(first);
    vec3 bias = front_bias(classify_segment(ahead, first), classify_segment(behind, first), factor * a.a, slab.length_mm);
    bias = whole ? bias : vec3(0.0);
    a = labelled(vec4(colour_of_mean(a, bias), a.a), first);
    b = labelled(vec4(colour_of_mean(b, bias), b.a), second);
    float seen_a = absorbed(0.5 * slab.length_mm * a.a);
    float seen_b = (1.0 - seen_a) * absorbed(0.5 * slab.length_mm * b.a);
    float share = seen_b / max(seen_a + seen_b, 1e-30);
    return vec4(a.rgb + share * (b.rgb - a.rgb), 0.5 * (a.a + b.a));
}
#endif
#endif

bool take_slab(inout State state, Slab slab) {
#if SCHEME == MIDPOINT
    vec4 c = material(slab.centre);
    state.depth += c.a * slab.length_mm;
    float transmittance = exp(-state.depth);
    state.colour += (state.transmittance - transmittance) * c.rgb;
    state.transmittance = transmittance;
#elif SCHEME == PREINTEGRATED
    // The value is taken to run straight through two Gauss points, which keeps its mean to fourth order: a line through the
    // slab's ends would be twice as far off as a single sample in the middle where the value curves.
    float before = sample_volume(to_sample(slab.centre - gauss_point * slab.extent));
    float behind = sample_volume(to_sample(slab.centre + gauss_point * slab.extent));
    float middle = 0.5 * (before + behind);
    float rise = 0.8660254037844386 * (behind - before);
#ifdef LABELS
    vec4 seen = slab_in_segments(slab, before, behind, middle, rise);
#else
    vec4 mean = slab_mean(middle - rise, middle + rise, 0);
    vec3 bias = front_bias(classify(before), classify(behind), mean.a, slab.length_mm);
    vec4 seen = vec4(colour_of_mean(mean, bias), mean.a);
#endif
    vec4 c = appearance(seen, slab.centre);
    state.depth += c.a * slab.length_mm;
    float transmittance = exp(-state.depth);
    state.colour += (state.transmittance - transmittance) * c.rgb;
    state.transmittance = transmittance;
#else
    // Two Gauss points, fourth order (spec: accuracy F15). Their weights are scaled so that they add up to the slab's
    // opacity, which they do only for thin slabs: otherwise an opaque surface would come out dark. So only their ratio counts,
    // and between them lies the optical depth of so much of the slab, however extinction rises.
    vec4 a = material(slab.centre - gauss_point * slab.extent);
    vec4 b = material(slab.centre + gauss_point * slab.extent);
    float depth = slab.length_mm * 0.5 * (a.a + b.a);
    float behind = b.a * exp(-2.0 * gauss_point * depth);
    state.depth += depth;
    float transmittance = exp(-state.depth);
    float share = behind / max(a.a + behind, 1e-30);
    state.colour += (state.transmittance - transmittance) * mix(a.rgb, b.rgb, share);
    state.transmittance = transmittance;
#endif
#ifdef TERMINATE
    return state.depth > u_depth_limit;
#else
    return false;
#endif
}

// Where a ray was left early, what lies behind is taken to look like what lies in front: without it, every opaque pixel
// would be too dark by what was left out. Off by at most the transmittance that was left.
vec4 finish(State state) {
    float opacity = 1.0 - exp(-state.depth);
#ifdef TERMINATE
    if (state.depth > u_depth_limit) {
        return vec4(state.colour / opacity, 1.0);
    }
#endif
    return vec4(state.colour, opacity);
}

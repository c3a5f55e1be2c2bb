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

bool take_slab(inout State state, Slab slab) {
#if SCHEME == 0
    vec4 c = material(slab.centre);
    state.depth += c.a * slab.length;
    float transmittance = exp(-state.depth);
    state.colour += (state.transmittance - transmittance) * c.rgb;
    state.transmittance = transmittance;
#elif SCHEME == 1
    // Two Gauss points, fourth order (spec: accuracy F15).
    const float g = 0.28867513459481287;
    vec4 a = material(slab.centre - g * slab.extent);
    vec4 b = material(slab.centre + g * slab.extent);
    float mean = 0.5 * (a.a + b.a);
    float slope = 0.8660254037844386 * (b.a - a.a);
    // Optical depth from the slab's start to each point: h (mean (u + 1/2) + slope (u^2 - 1/4)), u = -+g.
    const float bend = g * g - 0.25;
    float before_a = slab.length * (mean * (0.5 - g) + slope * bend);
    float before_b = slab.length * (mean * (0.5 + g) + slope * bend);
    state.colour += 0.5 * slab.length *
                    (a.a * exp(-(state.depth + before_a)) * a.rgb + b.a * exp(-(state.depth + before_b)) * b.rgb);
    state.depth += slab.length * mean;
#endif
    return state.depth > u_depth_limit;
}

vec4 finish(State state) {
    return vec4(state.colour, 1.0 - exp(-state.depth));
}

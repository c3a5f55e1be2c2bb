// The field along a piece of a ray that lies in one trilinear cell: a cubic, found from four values.
// Bernstein coefficients on [0, 1]: they bound the cubic, so most cells are done with at a glance.
vec4 cell_cubic(Slab slab) {
    vec3 begin = slab.centre - 0.5 * slab.extent;
    float f0 = sample_volume(to_sample(begin));
    float f1 = sample_volume(to_sample(begin + slab.extent * (1.0 / 3.0)));
    float f2 = sample_volume(to_sample(begin + slab.extent * (2.0 / 3.0)));
    float f3 = sample_volume(to_sample(begin + slab.extent));
    return vec4(f0, (-5.0 * f0 + 18.0 * f1 - 9.0 * f2 + 2.0 * f3) / 6.0,
                (2.0 * f0 - 9.0 * f1 + 18.0 * f2 - 5.0 * f3) / 6.0, f3);
}

// De Casteljau: forms only means of the coefficients, so nothing cancels.
float cubic_value(vec4 b, float u) {
    vec3 q = mix(b.xyz, b.yzw, u);
    vec2 l = mix(q.xy, q.yz, u);
    return mix(l.x, l.y, u);
}

// Where the cubic turns, cut to [0, 1]; both ends where it does not.
vec2 cubic_turns(vec4 b) {
    // Derivative / 3 in Bernstein form (d0, d1, d2): d0 (1-u)^2 + 2 d1 u (1-u) + d2 u^2.
    vec3 d = b.yzw - b.xyz;
    float a = d.x - 2.0 * d.y + d.z;
    float h = d.y - d.x;  // a u^2 + 2 h u + d.x
    float root = sqrt(max(h * h - a * d.x, 0.0));
    // The stable pair: the sum of magnitudes first, the other from the product of the roots.
    float q = -(h + (h >= 0.0 ? root : -root));
    float u0 = abs(a) > 1e-30 ? q / a : 0.0;
    float u1 = abs(q) > 1e-30 ? d.x / q : 0.0;
    vec2 turns = clamp(vec2(min(u0, u1), max(u0, u1)), 0.0, 1.0);
    return h * h > a * d.x ? turns : vec2(0.0, 1.0);
}

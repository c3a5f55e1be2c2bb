// Energy of a contact that moved from one place to another at an even speed while it gave `dose`: the mean of
// its Gaussian over the way. LONG_WAYS: some contact of this frame moved by more than its sigma.

// What exp(-x^2 / 2) averaged over x - q .. x + q is of exp(-x^2 / 2), q <= 0.5: the series in q of its
// closed form, whose difference of two error functions would lose digits. Hermite polynomials; the first term
// left out is below 3e-8.
float share_of_short_way(float x2, float q) {
    float q2 = q * q;
    float h2 = x2 - 1.0;
    float h4 = (x2 - 6.0) * x2 + 3.0;
    float h6 = ((x2 - 15.0) * x2 + 45.0) * x2 - 15.0;
    float h8 = (((x2 - 28.0) * x2 + 210.0) * x2 - 420.0) * x2 + 105.0;
    return 1.0 + q2 * (h2 / 6.0 + q2 * (h4 / 120.0 + q2 * (h6 / 5040.0 + q2 * (h8 / 362880.0))));
}

#ifdef LONG_WAYS
// Abramowitz and Stegun 7.1.26: off by at most 1.5e-7.
float error_function(float x) {
    float a = abs(x);
    float t = 1.0 / (1.0 + 0.3275911 * a);
    float poly =
        ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t;
    float y = 1.0 - poly * exp(-a * a);
    return x < 0.0 ? -y : y;
}

// The average itself.
float mean_of_long_way(float x, float q) {
    const float root_half = 0.70710678;
    const float root_half_pi = 1.25331414;
    return root_half_pi / (2.0 * q) * (error_function((x + q) * root_half) - error_function((x - q) * root_half));
}
#endif

// Three items per contact: middle of the way and dose; direction and half its length; 1 / sigma, reach^2, action, step.
// Adds to the sum of the contact's action, and keeps the largest dose of any that reaches here.
void add_contact(vec4 middle, vec4 way, vec4 kind, vec3 place, inout vec3 sums, inout vec3 largest) {
    vec3 from = place - middle.xyz;
    float along = dot(from, way.xyz);
    vec3 beside = from - along * way.xyz;
    float beyond = max(abs(along) - way.w, 0.0);
    float beside2 = dot(beside, beside);
    float inverse_sigma = kind.x;
    float x = along * inverse_sigma;
    float q = way.w * inverse_sigma;
    float across2 = beside2 * inverse_sigma * inverse_sigma;
    // Written so that a place or distance that is not a number adds nothing.
    bool reached = beside2 + beyond * beyond < kind.y;
    float exponent = across2 + x * x;
    float factor = share_of_short_way(x * x, q);
#ifdef LONG_WAYS
    exponent = q > 0.5 ? across2 : exponent;
    factor = q > 0.5 ? mean_of_long_way(x, q) : factor;
#endif
    float amount = reached ? middle.w * max(exp(-0.5 * min(exponent, 170.0)) * factor, 0.0) : 0.0;
    vec3 chosen = vec3(equal(ivec3(0, 1, 2), ivec3(int(kind.z))));
    sums += chosen * amount;
    largest = max(largest, chosen * (reached ? middle.w : 0.0));
}

// What energy makes of tissue.
uniform vec3 u_coagulation_colour;
uniform vec2 u_coagulation;  // saturation, brightness

struct Burn {
    float coagulated;  // share
    float charred;     // share, beta
};

// energy: as the target holds it; NaN counts as untouched.
Burn burn_of(float energy) {
    float e = abs(energy) < 1e30 ? abs(energy) : 0.0;
    float alpha = 2.0 * (1.0 - exp2(-e));
    Burn burn;
    burn.charred = clamp(alpha - 0.85, 0.0, 1.0);
    const float start = 54.598150;  // exp(40 * 0.1)
    float decay = exp(-40.0 * min(alpha, 1.0));
#ifdef THESIS_BURN
    burn.coagulated = 1.0 / (1.0 + start * decay);
#else
    // The logistic less its value at 0, with the difference taken before the division: 0 at 0, to the bit.
    burn.coagulated = start * (1.0 - decay) / ((1.0 + start * decay) * (1.0 + start));
#endif
    return burn;
}

vec3 burnt(vec3 colour, Burn burn) {
    vec3 coagulated = mix(colour, u_coagulation_colour, u_coagulation.x) * u_coagulation.y;
    return mix(colour, coagulated, burn.coagulated) * (1.0 - burn.charred);
}

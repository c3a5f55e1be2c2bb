// What a dose of energy does to a texel. The rules are those of a step `e += inc` taken in the limit of many
// short steps, so that a long frame does what several short ones do: a threshold that is crossed on the way
// acts from the crossing on.

float coagulated(float e, float dose) {
    float from = abs(e);  // what was cut is burnt first
    float quick = clamp(0.5 - from, 0.0, dose);  // above 0.5 energy counts half
    return dose > 0.0 ? from + quick + 0.5 * (dose - quick) : e;
}

float sounded(float e, float dose, float e_max) {
    float most = min(0.9, e_max);
    return e <= 0.9 && abs(e) < e_max && dose > 0.0 ? min(e + dose, most) : e;
}

float dissected(float e, float dose, float e_max) {
    return e <= 0.02 && abs(e) < e_max && dose > 0.0 ? max(e - dose, -e_max) : e;
}

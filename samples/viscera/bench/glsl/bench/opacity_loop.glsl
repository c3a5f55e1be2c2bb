// S_25(a) term by term, as it is defined.
float contrast_opacity(float a) {
    float sum = 0.0;
    for (int i = 0; i < 25; ++i) {
        float start = float(i) / 25.0;
        sum += clamp(2.0 * (a - start) / (1.0 - start), 0.0, 1.0);
    }
    return min(1.0, sum);
}

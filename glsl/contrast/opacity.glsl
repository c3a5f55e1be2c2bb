// S_25(a) for a in [0, 1]: a convex piecewise linear curve is the maximum of its own lines, so the 25-term sum becomes five
// multiply-adds, within 3e-7 of it: effects/contrast/opacity_curve.h.
float contrast_opacity(float a) {
    float s = max(2.0 * a, 4.0833335 * a - 0.083333336);
    s = max(s, max(6.2572465 * a - 0.25724638, 8.529974 * a - 0.52997363));
    return min(1.0, max(s, 10.910926 * a - 0.9109260));
}

// Weights of the four voxels around a place for each axis, at a fraction `a` of the way from the second to the third,
// and their derivatives. Written in a and 1 - a, so that nothing cancels at either end.
struct Cubic {
    vec3 w0, w1, w2, w3;
};

#ifdef CUBIC_BSPLINE
Cubic cubic_weights(vec3 a) {
    vec3 b = 1.0 - a;
    return Cubic(b * b * b / 6.0, (4.0 - 3.0 * a * a * (2.0 - a)) / 6.0, (4.0 - 3.0 * b * b * (2.0 - b)) / 6.0,
                 a * a * a / 6.0);
}

Cubic cubic_slopes(vec3 a) {
    vec3 b = 1.0 - a;
    return Cubic(-0.5 * b * b, 0.5 * a * (3.0 * a - 4.0), 0.5 * b * (4.0 - 3.0 * b), 0.5 * a * a);
}
#else  // Catmull-Rom
Cubic cubic_weights(vec3 a) {
    vec3 b = 1.0 - a;
    return Cubic(-0.5 * a * b * b, b * (1.0 + a - 1.5 * a * a), a * (1.0 + b - 1.5 * b * b), -0.5 * b * a * a);
}

Cubic cubic_slopes(vec3 a) {
    vec3 b = 1.0 - a;
    return Cubic(0.5 * b * (3.0 * a - 1.0), 0.5 * a * (9.0 * a - 10.0), 0.5 * b * (10.0 - 9.0 * b),
                 0.5 * a * (1.0 - 3.0 * b));
}
#endif

// A drop is a texel: u, v, volume [mm^3], age [s]. Its shape is a paraboloid cap.
uniform vec4 u_drop;  // height over radius, thickness of its trail [mm], life [s], smallest volume [mm^3]

float drop_radius(float volume) {
    return pow(volume * (2.0 / 3.14159265) / u_drop.x, 1.0 / 3.0);
}

/// Noise in [0, 1) from whole numbers: the same on every device.
float drop_noise(uint index, uint salt) {
    uint x = index * 747796405u + salt * 2891336453u + 277803737u;
    x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
    x = (x >> 22u) ^ x;
    return float(x >> 8u) * (1.0 / 16777216.0);
}

/// A step in the tangent plane [mm] as a step in texels; metric: mm per texel in u and v, cosine between them.
vec2 texels_of(vec2 mm, vec4 metric) {
    vec2 lengths = max(metric.xy, vec2(1e-12));
    float sine = sqrt(max(1.0 - metric.z * metric.z, 0.0025));
    float v = mm.y / (lengths.y * sine);
    return vec2((mm.x - lengths.y * metric.z * v) / lengths.x, v);
}

// Density in [0, 1] as a function of the seconds since the contrast's first arrival: effects/contrast/bolus.h.
#ifdef BOLUS_TABLE
uniform sampler2D u_bolus_table;  // table_samples x 1
uniform float u_bolus_first;
uniform float u_bolus_inv_step;

float bolus(float since_arrival) {
    float u = (since_arrival - u_bolus_first) * u_bolus_inv_step;
    if (!(u >= 0.0)) {
        return 0.0;
    }
    int last = textureSize(u_bolus_table, 0).x - 1;
    u = min(u, float(last));
    int i = min(int(u), last - 1);
    // Own weights: hardware filters have as few as 8 bits.
    return mix(texelFetch(u_bolus_table, ivec2(i, 0), 0).r, texelFetch(u_bolus_table, ivec2(i + 1, 0), 0).r, u - float(i));
}
#else
uniform float u_bolus_amplitude;
uniform float u_bolus_inv_rise;
uniform float u_bolus_duration;
uniform float u_bolus_inv_washout;
uniform float u_bolus_tail_scale;
uniform float u_bolus_tail_offset;

float bolus(float since_arrival) {
    float u = clamp(since_arrival * u_bolus_inv_rise, 0.0, 1.0);
    float decay = exp(-max(0.0, since_arrival - u_bolus_duration) * u_bolus_inv_washout);
    return u_bolus_amplitude * (u * u * (3.0 - 2.0 * u)) * max(0.0, decay * u_bolus_tail_scale - u_bolus_tail_offset);
}
#endif

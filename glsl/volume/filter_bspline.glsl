// Cubic B-spline from eight trilinear fetches: all weights are positive, so two neighbours merge into one fetch between
// them. The pairs' sums are at least 1/6: no quotient below is 0/0.

// Trilinear fetches at x = low or high, mixed by share of high.
VOXEL bspline_line(float low, float high, float share, vec2 yz) {
    VOXEL a = linear_voxel(vec3(low, yz));
    VOXEL b = linear_voxel(vec3(high, yz));
    return a + share * (b - a);
}

VOXEL SAMPLE(vec3 place) {
    vec3 size = vec3(volume_size());
    vec3 p = place * size - 0.5;
    vec3 cell = floor(p);
    Cubic w = cubic_weights(p - cell);
    vec3 share = w.w2 + w.w3;
    vec3 low = (cell - 0.5 + w.w1 / (w.w0 + w.w1)) / size;
    vec3 high = (cell + 1.5 + w.w3 / share) / size;
    VOXEL v00 = bspline_line(low.x, high.x, share.x, low.yz);
    VOXEL v10 = bspline_line(low.x, high.x, share.x, vec2(high.y, low.z));
    VOXEL v01 = bspline_line(low.x, high.x, share.x, vec2(low.y, high.z));
    VOXEL v11 = bspline_line(low.x, high.x, share.x, high.yz);
    VOXEL v0 = v00 + share.y * (v10 - v00);
    VOXEL v1 = v01 + share.y * (v11 - v01);
    return v0 + share.z * (v1 - v0);
}

// The rise from one fetch to another, mixed over the two other axes, along which u and v lead to the second fetches.
float bspline_rise(vec3 from, vec3 to, vec3 u, vec3 v, float share_u, float share_v) {
    float d00 = linear_texel(to) - linear_texel(from);
    float d10 = linear_texel(to + u) - linear_texel(from + u);
    float d01 = linear_texel(to + v) - linear_texel(from + v);
    float d11 = linear_texel(to + u + v) - linear_texel(from + u + v);
    float d0 = d00 + share_u * (d10 - d00);
    float d1 = d01 + share_u * (d11 - d01);
    return d0 + share_v * (d1 - d0);
}

// The derivative's weights have one sign in each pair too, and sum to -+(1/2 + a (1 - a)).
vec3 filter_gradient(vec3 place) {
    vec3 size = vec3(volume_size());
    vec3 p = place * size - 0.5;
    vec3 cell = floor(p);
    vec3 a = p - cell;
    Cubic w = cubic_weights(a);
    Cubic d = cubic_slopes(a);
    vec3 share = w.w2 + w.w3;
    vec3 low = (cell - 0.5 + w.w1 / (w.w0 + w.w1)) / size;
    vec3 high = (cell + 1.5 + w.w3 / share) / size;
    vec3 sum = 0.5 + a * (1.0 - a);
    vec3 from = (cell - 0.5 - d.w1 / sum) / size;
    vec3 to = (cell + 1.5 + d.w3 / sum) / size;
    vec3 x = vec3(high.x - low.x, 0.0, 0.0);
    vec3 y = vec3(0.0, high.y - low.y, 0.0);
    vec3 z = vec3(0.0, 0.0, high.z - low.z);
    return size * sum *
           vec3(bspline_rise(vec3(from.x, low.yz), vec3(to.x, low.yz), y, z, share.y, share.z),
                bspline_rise(vec3(low.x, from.y, low.z), vec3(low.x, to.y, low.z), x, z, share.x, share.z),
                bspline_rise(vec3(low.xy, from.z), vec3(low.xy, to.z), x, y, share.x, share.y));
}

// Tricubic reconstruction from 64 voxels, with weights of full precision.
// Everything is summed as differences from the second of four: a constant comes out as it is, and its derivative as 0.
vec4 cubic_mix(vec4 v0, vec4 v1, vec4 v2, vec4 v3, vec4 w) {
    return v1 + (w.x * (v0 - v1) + w.z * (v2 - v1) + w.w * (v3 - v1));
}

float cubic_slope(float v0, float v1, float v2, float v3, vec4 d) {
    return d.x * (v0 - v1) + d.z * (v2 - v1) + d.w * (v3 - v1);
}

// Along each axis: voxels (inside the volume), weights and derivatives.
struct CubicStencil {
    ivec4 x, y, z;
    vec4 wx, wy, wz;
    vec4 dx, dy, dz;
};

// Value and derivative along x (and what is still 0) of a row, a plane, and all.
vec4 cubic_row(CubicStencil s, int y, int z) {
    vec4 v = vec4(texel(ivec3(s.x.x, y, z)), texel(ivec3(s.x.y, y, z)), texel(ivec3(s.x.z, y, z)),
                  texel(ivec3(s.x.w, y, z)));
    return vec4(cubic_mix(v.xxxx, v.yyyy, v.zzzz, v.wwww, s.wx).x, cubic_slope(v.x, v.y, v.z, v.w, s.dx), 0.0, 0.0);
}

vec4 cubic_plane(CubicStencil s, int z) {
    vec4 r0 = cubic_row(s, s.y.x, z);
    vec4 r1 = cubic_row(s, s.y.y, z);
    vec4 r2 = cubic_row(s, s.y.z, z);
    vec4 r3 = cubic_row(s, s.y.w, z);
    return vec4(cubic_mix(r0, r1, r2, r3, s.wy).xy, cubic_slope(r0.x, r1.x, r2.x, r3.x, s.dy), 0.0);
}

CubicStencil cubic_stencil(vec3 place) {
    ivec3 size = volume_size();
    Cell cell = cell_at(place);
    Cubic w = cubic_weights(cell.a);
    Cubic d = cubic_slopes(cell.a);
    ivec3 i = ivec3(cell.low);
    const ivec4 taps = ivec4(-1, 0, 1, 2);
    CubicStencil s = CubicStencil(
        clamp(i.x + taps, ivec4(0), ivec4(size.x - 1)), clamp(i.y + taps, ivec4(0), ivec4(size.y - 1)),
        clamp(i.z + taps, ivec4(0), ivec4(size.z - 1)),
        vec4(w.w0.x, w.w1.x, w.w2.x, w.w3.x), vec4(w.w0.y, w.w1.y, w.w2.y, w.w3.y), vec4(w.w0.z, w.w1.z, w.w2.z, w.w3.z),
        vec4(d.w0.x, d.w1.x, d.w2.x, d.w3.x), vec4(d.w0.y, d.w1.y, d.w2.y, d.w3.y), vec4(d.w0.z, d.w1.z, d.w2.z, d.w3.z));
#ifdef COORDINATES
    s.ANGLE = on_ring(i.ANGLE + taps, size.ANGLE);
#endif
    return s;
}

// Value and derivative along x, y and z per voxel.
vec4 cubic_jet(vec3 place) {
    CubicStencil s = cubic_stencil(place);
    vec4 p0 = cubic_plane(s, s.z.x);
    vec4 p1 = cubic_plane(s, s.z.y);
    vec4 p2 = cubic_plane(s, s.z.z);
    vec4 p3 = cubic_plane(s, s.z.w);
    return vec4(cubic_mix(p0, p1, p2, p3, s.wz).xyz, cubic_slope(p0.x, p1.x, p2.x, p3.x, s.dz));
}

#ifdef COLOURS
vec4 cubic_colour_row(CubicStencil s, int y, int z) {
    return cubic_mix(voxel_at(ivec3(s.x.x, y, z)), voxel_at(ivec3(s.x.y, y, z)), voxel_at(ivec3(s.x.z, y, z)),
                     voxel_at(ivec3(s.x.w, y, z)), s.wx);
}

vec4 cubic_colour_plane(CubicStencil s, int z) {
    return cubic_mix(cubic_colour_row(s, s.y.x, z), cubic_colour_row(s, s.y.y, z), cubic_colour_row(s, s.y.z, z),
                     cubic_colour_row(s, s.y.w, z), s.wy);
}

vec4 cubic_colour(vec3 place) {
    CubicStencil s = cubic_stencil(place);
    return cubic_mix(cubic_colour_plane(s, s.z.x), cubic_colour_plane(s, s.z.y), cubic_colour_plane(s, s.z.z),
                     cubic_colour_plane(s, s.z.w), s.wz);
}
#endif

// What cylindrical and spherical volumes share: places between voxels, and the limits of rays.
// Local coordinates are Cartesian ones of the shape's own frame, in units of its outer radius. Angles are cut at +-pi, which
// lies in the middle of the gap, if there is one; on a ring texture coordinates go on beyond [0, 1] and are taken modulo 1.
// The effect's side: effects/volume/space.h.
uniform vec3 u_sample_scale;   // curvilinear coordinate -> texture coordinate, per axis
uniform vec3 u_sample_offset;
uniform vec3 u_sample_low;     // texture coordinates of the ends (a ring: far beyond both)
uniform vec3 u_sample_high;
uniform mat3 u_metric;         // gradient per local coordinate -> gradient per mm in the world
uniform float u_axis_guard;    // radius below which directions about the axis are not resolved

// Angle of v against the x axis, in [-pi, pi]; 0 for v = 0. To 1e-7: drivers' own atan may be off by 4e-6, and acos of
// a quotient loses half of the digits near the axis. From pi/8 on, the angle to the diagonal is found instead; the polynomial
// fits atan(t) / t up to tan(pi/8) within 5e-9.
float angle_of(vec2 v) {
    vec2 a = abs(v);
    float low = min(a.x, a.y);
    float high = max(a.x, a.y);
    bool upper = low > 0.41421356 * high;
    float t = (upper ? low - high : low) / max(upper ? low + high : high, 1e-30);
    float z = t * t;
    float angle = t + t * z * (-0.333327566 + z * (0.199718787 + z * (-0.138244488 + z * 0.0790258437)));
    angle = (upper ? 0.785398163397448 : 0.0) + angle;
    angle = a.y > a.x ? 1.570796326794897 - angle : angle;
    angle = v.x < 0.0 ? 3.141592653589793 - angle : angle;
    return v.y < 0.0 ? -angle : angle;
}

// Of length 1; x where there is no direction.
vec2 direction_of(vec2 v, float size) {
    return size > 0.0 ? v / size : vec2(1.0, 0.0);
}


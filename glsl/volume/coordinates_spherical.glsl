// Coordinate system of a sector of a sphere: see volume/curvilinear.glsl.
#include "volume/place_spherical.glsl"
uniform vec4 u_latitude;  // cosine and sine of the lowest and of the highest

// The ball and at most half a circle of longitudes are convex: one interval. Inner ball, gap and the two cones about the
// poles are convex holes. A line that is steeper than a cone leaves one nappe and enters the other, so that what lies between
// is one interval; one that is less steep meets one nappe alone. With cones of one slope that makes three holes and
// four pieces; a crop may give them two slopes, and then all four holes and five pieces can be.
const int max_intervals = 5;

vec2 ray_keep;
vec2 ray_inner;
vec2 ray_gap;
vec2 ray_south;
vec2 ray_north;
float ray_from;

// Where a line lies in the solid cone about the z axis (side 1) or about -z (side -1), from the latitude with the cosine
// c and the sine s >= 0 on. o: the line's closest approach to the centre.
vec2 cone_interval(vec3 o, vec3 d, float c, float s, float side) {
    // With X = z c and Y = (x, y) s the cone is X^2 >= Y^2.
    float xo = o.z * c;
    float xd = d.z * c;
    vec2 yo = o.xy * s;
    vec2 yd = d.xy * s;
    float lo = length(yo);
    float ld = length(yd);
    float a = (xd - ld) * (xd + ld);
    float b = xo * xd - dot(yo, yd);
    float q0 = (xo - lo) * (xo + lo);
    // b^2 - a q0, without what cancels in it.
    float w = length(xd * yo - xo * yd);
    float k = abs(yo.x * yd.y - yo.y * yd.x);
    float root = sqrt(max((w - k) * (w + k), 0.0));
    if (a < 0.0 && w <= k) {
        return nothing;
    }
    float q = -(b + (b >= 0.0 ? root : -root));
    float s0 = q / (abs(a) < 1e-20 ? (a < 0.0 ? -1e-20 : 1e-20) : a);
    float s1 = abs(q) < 1e-30 ? s0 : q0 / q;
    float low = min(s0, s1);
    float high = max(s0, s1);
    if (a < 0.0) {  // between both, in one nappe
        return side * (o.z + 0.5 * (low + high) * d.z) > 0.0 ? vec2(low, high) : nothing;
    }
    return side * d.z > 0.0 ? vec2(high, far_away) : vec2(-far_away, low);
}

// Latitudes beyond one end, or on this side of it, are a cone: whichever is convex.
void cut_latitude(vec3 o, vec3 d, float t, float c, float s, float side, inout vec2 keep, out vec2 hole) {
    hole = nothing;
    if (c < 1e-6) {  // up to the pole
        return;
    }
    if (side * s >= 0.0) {
        hole = hole_or_nothing(cone_interval(o, d, c, abs(s), side) + t);
    } else {
        keep = meet(keep, cone_interval(o, d, c, abs(s), -side) + t);
    }
}

vec2 ray_interval(Ray ray, int index) {
    float per_mm = length(ray.direction);
    if (index == 0) {
        vec3 o = ray.origin;
        vec3 d = ray.direction / per_mm;
        ray_keep = ball_interval(o, d, u_radius_high);
        cut_wedge(o.xy, d.xy, ray_keep, ray_gap);
        ray_gap = hole_or_nothing(ray_gap);
        ray_inner = hole_or_nothing(u_radius_low > 0.0 ? ball_interval(o, d, u_radius_low) : nothing);
        float t = -dot(o, d);
        o += t * d;
        cut_latitude(o, d, t, u_latitude.x, u_latitude.y, -1.0, ray_keep, ray_south);
        cut_latitude(o, d, t, u_latitude.z, u_latitude.w, 1.0, ray_keep, ray_north);
        ray_from = ray_keep.x;
    }
    return next_piece(ray_from, ray_keep.y, ray_inner, ray_gap, ray_south, ray_north) / per_mm;
}

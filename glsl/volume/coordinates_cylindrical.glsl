// Coordinate system of a sector of a cylinder: see volume/curvilinear.glsl.
#include "volume/place_cylindrical.glsl"
uniform vec2 u_height;  // low and high

// Outer cylinder, planes and at most half a circle are convex: one interval. The inner cylinder and a gap of less than half a
// circle are convex as well: two holes at most leave three pieces.
const int max_intervals = 3;

vec2 ray_keep;
vec2 ray_inner;
vec2 ray_gap;
float ray_from;

// Pieces in order, for index 0, 1, ... one after the other.
vec2 ray_interval(Ray ray, int index) {
    float per_mm = length(ray.direction);
    if (index == 0) {
        vec3 o = ray.origin;
        vec3 d = ray.direction / per_mm;
        ray_keep = meet(cylinder_interval(o.xy, d.xy, u_radius_high), slab_interval(o.z, d.z, u_height.x, u_height.y));
        cut_wedge(o.xy, d.xy, ray_keep, ray_gap);
        ray_gap = hole_or_nothing(ray_gap);
        ray_inner = hole_or_nothing(u_radius_low > 0.0 ? cylinder_interval(o.xy, d.xy, u_radius_low) : nothing);
        ray_from = ray_keep.x;
    }
    return next_piece(ray_from, ray_keep.y, ray_inner, ray_gap, nothing, nothing) / per_mm;
}

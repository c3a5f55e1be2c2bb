// Runs of slabs that lie in bricks of one kind, as volume/skip.glsl finds them, for rays that are curved in sample space:
// bricks are bounded by cylinders, cones, spheres and planes, and a run ends where the ray meets the first of them.
// Everything is solved from the place in question, so that no distance to it costs digits.
uniform usampler3D u_bricks;     // kind * 32 + distance to the nearest brick of another kind
uniform vec3 u_bricks_per_unit;  // bricks per texture coordinate
uniform vec3 u_occupied_low;     // box around all bricks that are not empty [bricks]
uniform vec3 u_occupied_high;

const uint run_empty = 0U;
const uint run_full = 1U;    // every slab is sampled
// 1 + i: the transfer function hardly changes here, slabs of 4^i do

// Next to the box's faces a run is one slab [bricks], and elsewhere it ends half of that before them: rounding then never
// loses a face that the ray is about to meet. Brick ranges have a border of more than a cell, so this is far more than needed.
const float face_margin = 0.01;

struct Leaper {
    vec3 first;    // position of the march's start
    vec3 extent;   // per unit of the march
};

struct Run {
    float extent;  // from the place asked for to the end of the run, in units of the march
    uint kind;
};

Leaper make_leaper(vec3 first, vec3 extent) {
    return Leaper(first, extent);
}

const float never = 3e38;

// On to where |p + t e| = outer, from inside; b = p.e, ee = e.e.
float leave_outwards(float radius, float b, float ee, float outer) {
    float c = (outer - radius) * (outer + radius);
    float root = sqrt(max(b * b + ee * c, 0.0));
    return b > 0.0 ? c / max(b + root, 1e-30) : (root - b) / max(ee, 1e-30);
}

// On to where |p + t e| = inner, from outside.
float leave_inwards(float radius, float b, float ee, float inner) {
    float c = (radius - inner) * (radius + inner);
    float disc = b * b - ee * c;
    return inner > 0.0 && b < 0.0 && disc > 0.0 ? c / max(sqrt(disc) - b, 1e-30) : never;
}

// On to the half-plane at an angle; `swing` is the way to it in the direction in which the ray turns, >= 0. What is half a
// circle away or more is never reached.
float leave_angle(vec2 p, vec2 e, float angle, float swing, float turn) {
    vec2 edge = vec2(cos(angle), sin(angle));
    float height = abs(edge.x * p.y - edge.y * p.x);
    float rise = turn * (edge.x * e.y - edge.y * e.x);
    return swing < 3.14159 && rise > 0.0 ? height / max(rise, 1e-30) : never;
}

float leave_plane(float p, float e, float low, float high) {
    return (e > 0.0 ? high - p : p - low) / max(abs(e), 1e-30);
}

// On to the double cone of a latitude, whichever half comes first.
float leave_cone(vec3 p, vec3 e, float latitude) {
    if (abs(latitude) > 1.5707) {  // no cone at the poles
        return never;
    }
    float c = cos(latitude);
    float s = sin(latitude);
    float x = p.z * c;
    float xe = e.z * c;
    float y = length(p.xy) * s;
    float ye = length(e.xy) * s;
    float a = (xe - ye) * (xe + ye);
    float b = x * xe - dot(p.xy, e.xy) * s * s;
    float q0 = (x - y) * (x + y);
    float disc = b * b - a * q0;
    if (disc < 0.0) {
        return never;
    }
    float q = -(b + (b >= 0.0 ? sqrt(disc) : -sqrt(disc)));
    float t0 = abs(a) > 1e-30 ? q / a : never;
    float t1 = abs(q) > 1e-30 ? q0 / q : never;
    t0 = t0 > 0.0 ? t0 : never;
    t1 = t1 > 0.0 ? t1 : never;
    return min(t0, t1);
}

Run run_from(Leaper leaper, float at) {
    vec3 p = leaper.first + at * leaper.extent;
    vec3 e = leaper.extent;
    vec3 place = to_sample(p);
    // The map knows nothing of the seam; runs end there.
    float angle = place.ANGLE - (u_ring ? floor(place.ANGLE) : 0.0);
    place.ANGLE = angle;
    vec3 in_bricks = place * u_bricks_per_unit;
    ivec3 brick = clamp(ivec3(floor(in_bricks)), ivec3(0), textureSize(u_bricks, 0) - 1);
    uint entry = texelFetch(u_bricks, brick, 0).r;
    float reach = float(entry & 31u);
    vec3 low = vec3(brick) - (reach - 1.0);
    vec3 high = vec3(brick) + reach;
    low.ANGLE = max(low.ANGLE, u_ring ? 0.0 : u_sample_low.ANGLE * u_bricks_per_unit.ANGLE);
    high.ANGLE = min(high.ANGLE, u_bricks_per_unit.ANGLE * (u_ring ? 1.0 : u_sample_high.ANGLE));
    bool inside = all(greaterThan(in_bricks, low + face_margin)) && all(lessThan(in_bricks, high - face_margin));
    // Curvilinear coordinates of the faces.
    low = ((low + 0.5 * face_margin) / u_bricks_per_unit - u_sample_offset) / u_sample_scale;
    high = ((high - 0.5 * face_margin) / u_bricks_per_unit - u_sample_offset) / u_sample_scale;
    float turned = (angle - u_sample_offset.ANGLE) / u_sample_scale.ANGLE;
    float turn = p.x * e.y - p.y * e.x >= 0.0 ? 1.0 : -1.0;
    float edge = turn > 0.0 ? high.ANGLE : low.ANGLE;
    float leave = leave_angle(p.xy, e.xy, edge, abs(edge - turned), turn);
#if COORDINATES == 1
    float radius = length(p.xy);
    float b = dot(p.xy, e.xy);
    float ee = dot(e.xy, e.xy);
    leave = min(leave, min(leave_outwards(radius, b, ee, high.x), leave_inwards(radius, b, ee, low.x)));
    leave = min(leave, leave_plane(p.z, e.z, low.z, high.z));
#else
    float radius = length(p);
    float b = dot(p, e);
    float ee = dot(e, e);
    leave = min(leave, min(leave_outwards(radius, b, ee, high.z), leave_inwards(radius, b, ee, low.z)));
    leave = min(leave, min(leave_cone(p, e, low.y), leave_cone(p, e, high.y)));
#endif
    return Run(inside ? max(leave, 0.0) : 0.0, entry >> 5);
}

// Where the march enters and leaves what lies within the outermost radius, and between the heights, at which anything is to
// be seen. Wider by a margin that is far more than what a grazing ray's root may be off.
vec2 occupied_span(Leaper leaper) {
    vec3 high = (u_occupied_high + face_margin) / u_bricks_per_unit;
    high = (min(high, vec3(1.0)) - u_sample_offset) / u_sample_scale;
    vec3 p = leaper.first;
    vec3 e = leaper.extent;
#if COORDINATES == 1
    float outer = high.x;
    float low_height = ((u_occupied_low.z - face_margin) / u_bricks_per_unit.z - u_sample_offset.z) / u_sample_scale.z;
    vec2 heights = vec2(leave_plane(p.z, -e.z, low_height, high.z), leave_plane(p.z, e.z, low_height, high.z));
    vec2 span = abs(e.z) > 1e-30 ? vec2(-heights.x, heights.y) : vec2(0.0, never);
    p.z = 0.0;
    e.z = 0.0;
#else
    float outer = high.z;
    vec2 span = vec2(0.0, never);
#endif
    float b = dot(p, e);
    float ee = max(dot(e, e), 1e-30);
    float closest = length(p - b / ee * e);
    float root = sqrt(max((outer - closest) * (outer + closest) / ee, 0.0));
    vec2 inside = vec2(-b / ee - root, -b / ee + root);
    return closest < outer ? vec2(max(span.x, inside.x), min(span.y, inside.y)) : vec2(0.0);
}

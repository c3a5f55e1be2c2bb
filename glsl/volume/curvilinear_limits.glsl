// Parts of a ray in a sector of a cylinder or sphere. What of the ray can lie in the volume is an interval, from which
// convex holes are cut: the inner radius, the gap between the ends of more than half a circle, and for spheres the cone
// about a pole. Lengths are of the ray in local coordinates, whose direction has length 1.
uniform float u_radius_low;
uniform float u_radius_high;
uniform int u_wedge;           // angles: 0 all around, 1 at most half a circle, 2 more
uniform vec2 u_wedge_low;      // normals of the end planes, into the volume
uniform vec2 u_wedge_high;

const float far_away = 1e24;
const vec2 nothing = vec2(3e38, -3e38);

vec2 meet(vec2 a, vec2 b) {
    return vec2(max(a.x, b.x), min(a.y, b.y));
}

// Where a line lies within `radius` of the origin (of the axis: o and d without z). `t` to the closest approach, which is
// found twice: the second time from near-by, without the digits that the first cost (spec: accuracy F16).
// The discriminant is a product of sum and difference: squares would cancel where the line grazes.
vec2 round_interval(float t, float closest, float dd, float oo, float radius) {
    float q = (radius - closest) * (radius + closest) / max(dd, 1e-30);
    if (!(q > 0.0)) {
        return nothing;
    }
    float h = sqrt(q);
    vec2 interval = vec2(t - h, t + h);
    // A line nearly along the axis comes closest far away: the near end is the quotient of the product of both.
    float other = (sqrt(oo) - radius) * (sqrt(oo) + radius) / (dd * (abs(t) + h));
    bool remote = abs(t) > 4.0 * radius;
    interval.x = remote && t > 0.0 ? other : interval.x;
    interval.y = remote && t < 0.0 ? -other : interval.y;
    return interval;
}

vec2 cylinder_interval(vec2 o, vec2 d, float radius) {
    float dd = dot(d, d);
    if (dd < 1e-20) {  // along the axis
        return dot(o, o) <= radius * radius ? vec2(-far_away, far_away) : nothing;
    }
    float t = -dot(o, d) / dd;
    vec2 p = o + t * d;
    float e = -dot(p, d) / dd;
    p += e * d;
    return round_interval(t + e, length(p), dd, dot(o, o), radius);
}

vec2 ball_interval(vec3 o, vec3 d, float radius) {
    float t = -dot(o, d);
    vec3 p = o + t * d;
    float e = -dot(p, d);
    p += e * d;
    return round_interval(t + e, length(p), 1.0, dot(o, o), radius);
}

// Where height + s * rise is not below 0. `edge`: whether a line that runs in the plane itself counts.
vec2 half_line(float height, float rise, bool edge) {
    if (abs(rise) < 1e-30) {
        return height > 0.0 || (edge && height == 0.0) ? vec2(-far_away, far_away) : nothing;
    }
    float s = -height / rise;
    return rise > 0.0 ? vec2(s, far_away) : vec2(-far_away, s);
}

vec2 slab_interval(float o, float d, float low, float high) {
    return meet(half_line(o - low, d, true), half_line(high - o, -d, true));
}

// The angles: an interval to keep, and one to leave out.
void cut_wedge(vec2 o, vec2 d, inout vec2 keep, out vec2 gap) {
    gap = nothing;
    if (u_wedge == 1) {
        keep = meet(keep, meet(half_line(dot(u_wedge_low, o), dot(u_wedge_low, d), true),
                                   half_line(dot(u_wedge_high, o), dot(u_wedge_high, d), true)));
    } else if (u_wedge == 2) {
        gap = meet(half_line(-dot(u_wedge_low, o), -dot(u_wedge_low, d), false),
                     half_line(-dot(u_wedge_high, o), -dot(u_wedge_high, d), false));
    }
}

vec2 hole_or_nothing(vec2 hole) {
    return hole.x < hole.y ? hole : nothing;
}

// What is left, piece by piece: `from` moves on. Holes that touch or overlap are passed together.
float leave_holes(float from, vec2 a, vec2 b, vec2 c, vec2 d) {
    from = a.x <= from && from < a.y ? a.y : from;
    from = b.x <= from && from < b.y ? b.y : from;
    from = c.x <= from && from < c.y ? c.y : from;
    return d.x <= from && from < d.y ? d.y : from;
}

vec2 next_piece(inout float from, float end, vec2 a, vec2 b, vec2 c, vec2 d) {
    float start = from;
    for (int i = 0; i < 4; ++i) {
        start = leave_holes(start, a, b, c, d);
    }
    end = a.x > start ? min(end, a.x) : end;
    end = b.x > start ? min(end, b.x) : end;
    end = c.x > start ? min(end, c.x) : end;
    end = d.x > start ? min(end, d.x) : end;
    from = max(end, start);
    return vec2(start, end);
}

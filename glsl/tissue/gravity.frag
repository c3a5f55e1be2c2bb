#version 330 core
// Which way things run down a surface, in texture space, and what drives a film through each face between two texels.
uniform sampler2D u_position;  // world [mm]; w: 1 surface, 0.5 gutter
uniform sampler2D u_normal;
uniform sampler2D u_metric;  // mm per texel in u and v, cosine between them, mm^2
uniform sampler2D u_seam;    // UV where the surface goes on; -1: nowhere
uniform vec3 u_down;         // direction of gravity, or 0
uniform float u_strength;    // in units of standard gravity
uniform bool u_open;         // a film runs off open borders
uniform float u_spreading;   // least share of gravity that levels a film
layout(location = 0) out vec4 o_gravity;  // direction in UV, |tangential| / |gravity|, UV per mm along it
layout(location = 1) out vec4 o_right;    // face to the right: spread, skew, drive [mm], share of area [mm^2]; in gutters see main()
layout(location = 2) out vec4 o_top;      // face to the top

#include "tissue/downhill.glsl"
#include "tissue/relief.glsl"

// What a texel is: 2 surface, 1 gutter that continues it, 0 nothing.
const float surface = 2.0;
const float continued = 1.0;

ivec2 last;

float kind(ivec2 at) {
    if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
        return 0.0;
    }
    float coverage = texelFetch(u_position, at, 0).w;
    // An area that is not a number above 0 carries nothing.
    if (coverage > 0.75) {
        float area = texelFetch(u_metric, at, 0).w;
        return area > 1e-20 && area < 1e20 ? surface : 0.0;
    }
    return coverage > 0.25 && texelFetch(u_seam, at, 0).x >= 0.0 ? continued : 0.0;
}

vec3 position(ivec2 at) {
    return texelFetch(u_position, clamp(at, ivec2(0), last), 0).xyz;
}

/// Change of position per texel along an axis, and w: what the relief adds to the rise: central, one-sided at borders.
vec4 step_along(ivec2 at, ivec2 axis) {
    bool before = kind(at - axis) > 0.0;
    bool after = kind(at + axis) > 0.0;
    ivec2 low = before ? at - axis : at;
    ivec2 high = after ? at + axis : at;
    vec3 way = position(high) - position(low);
    return (before && after ? 0.5 : 1.0) * vec4(way, relief_rise(low, high, way));
}

struct Local {
    vec2 conductance;  // through faces across u and across v
    float skew;
};

Local local(ivec2 at) {
    vec4 metric = texelFetch(u_metric, at, 0);
    float sine = sqrt(max(1.0 - metric.z * metric.z, 0.0025));
    vec2 lengths = max(metric.xy, vec2(1e-12));
    float ratio = clamp(lengths.y / lengths.x, 1e-3, 1e3);
    return Local(vec2(ratio, 1.0 / ratio) / sine, -metric.z / sine);
}

float upward(ivec2 at) {
    return max(-dot(u_down, texelFetch(u_normal, at, 0).xyz), u_spreading);
}

// Positions count from a point nearby, which keeps the digits of a surface far from the origin.
float height(ivec2 at, vec3 origin) {
    return -dot(u_down, position(at) - origin);
}

/// The flow downhill at a texel (downhill.glsl).
vec2 downhill(ivec2 at, bool with_relief, out float factor, out float scale) {
    vec4 du = step_along(at, ivec2(1, 0));
    vec4 dv = step_along(at, ivec2(0, 1));
    return flow_downhill(u_down, du.xyz, dv.xyz, with_relief ? vec2(du.w, dv.w) : vec2(0.0), factor, scale);
}

/// How much of what a cell holds may leave it in one step through a face, times 4: most of it downhill, and never more than all of it
/// through its four faces together. The relief has no say: over it pools level in any direction.
float share(ivec2 cell, ivec2 axis) {
    float factor;
    float scale;
    vec2 flow = abs(downhill(cell, false, factor, scale));
    float sum = flow.x + flow.y;
    return sum > 0.0 ? 0.4 + 2.4 * dot(flow, vec2(axis)) / sum : 1.0;
}

vec4 face(ivec2 a, ivec2 axis, float kind_a, vec3 origin) {
    ivec2 b = a + axis;
    ivec2 along = axis.yx;
    // Beyond the texture nobody could say what came there.
    if (any(lessThan(a, ivec2(0))) || any(greaterThan(b, last))) {
        return vec4(0.0);
    }
    float kind_b = kind(b);
    bool from_a = kind_a == surface;
    bool from_b = kind_b == surface;
    if (from_a && from_b) {
        Local la = local(a);
        Local lb = local(b);
        float conductance = 0.5 * dot(la.conductance + lb.conductance, vec2(axis));
        float skew = 0.5 * (la.skew + lb.skew);
        vec4 beside = step_along(a, along) + step_along(b, along);
        float across = -0.5 * (dot(u_down, beside.xyz) - beside.w);
        float rise = height(b, origin) - height(a, origin) + relief_rise(a, b, position(b) - position(a));
        float n = 0.5 * (upward(a) + upward(b));
        float drive = -(conductance * rise + skew * across);
        return vec4(u_strength * vec3(conductance * n, skew * n, drive),
                    share(drive > 0.0 ? a : b, axis) * min(texelFetch(u_metric, a, 0).w, texelFetch(u_metric, b, 0).w));
    }
    if (!u_open || from_a == from_b || kind_a == continued || kind_b == continued) {
        return vec4(0.0);
    }
    // Over an open border the film goes on as the surface falls just before it. A border that slants through the grid has steps, which a
    // film that runs along it must not fall off.
    ivec2 cell = from_a ? a : b;
    float factor;
    float scale;
    vec2 flow = downhill(cell, false, factor, scale);
    vec2 outward = vec2(0.0);
    for (int i = 0; i < 9; ++i) {
        ivec2 way = ivec2(i % 3 - 1, i / 3 - 1);
        outward += kind(cell + way) == 0.0 ? vec2(way) : vec2(0.0);
    }
    if (dot(flow, outward) < 0.3 * length(flow) * length(outward)) {
        return vec4(0.0);
    }
    Local l = local(cell);
    vec4 way = dot(l.conductance, vec2(axis)) * step_along(cell, axis) + l.skew * step_along(cell, along);
    float drive = dot(u_down, way.xyz) - way.w;
    return from_a == (drive > 0.0) ? vec4(0.0, 0.0, u_strength * drive, share(cell, axis) * texelFetch(u_metric, cell, 0).w)
                                      : vec4(0.0);
}

/// The texel of the surface that is nearest to a place [texels], among the 3 x 3 around it. Beside a border the texel at the place itself
/// need not be one.
vec2 nearest_surface(vec2 place) {
    ivec2 middle = ivec2(floor(place + 0.5));
    float nearest = 1e9;
    ivec2 found = middle;
    for (int i = 0; i < 9; ++i) {
        ivec2 there = middle + ivec2(i % 3 - 1, i / 3 - 1);
        vec2 away = vec2(there) - place;
        float distance = dot(away, away);
        if (kind(there) == surface && distance < nearest) {
            nearest = distance;
            found = there;
        }
    }
    return vec2(found);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    last = textureSize(u_position, 0) - 1;
    float here = kind(at);
    vec3 origin = position(at);
    if (here == surface) {
        o_right = face(at, ivec2(1, 0), here, origin);
        o_top = face(at, ivec2(0, 1), here, origin);
    } else if (here == continued) {
        // A gutter has no faces; it says where the surface goes on, and which texel there is nearest. Below 0 no face has an area.
        vec2 place = texelFetch(u_seam, at, 0).xy * vec2(last + 1) - 0.5;
        vec2 cell = nearest_surface(place);
        o_right = vec4(place, cell.x, -1.0 - cell.y);
        o_top = vec4(0.0);
    } else {
        origin = position(at + ivec2(1, 0));
        o_right = face(at, ivec2(1, 0), here, origin);
        o_top = face(at, ivec2(0, 1), here, position(at + ivec2(0, 1)));
    }

    o_gravity = vec4(0.0);
    if (here > 0.0) {
        float factor;
        float scale;
        vec2 direction = downhill(at, true, factor, scale) / vec2(last + 1);
        float size = length(direction);
        if (size > 0.0) {
            o_gravity = vec4(direction / size, min(factor, 1.0), size / factor * scale);
        }
    }
}

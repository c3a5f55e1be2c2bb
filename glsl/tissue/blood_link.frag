#version 330 core
#include "tissue/blood_part.glsl"
// What drives a film through the parts of seams. A part joins a cell to one across the seam as if they were neighbours; its share of
// their common face is at most one half, since the other side has parts of its own there.
uniform sampler2D u_links;  // cell, cell across, side (0 right, 1 left, 2 top, 3 bottom; 4 more: its last one), share (negative: as seen from across)
uniform sampler2D u_position;
uniform sampler2D u_normal;
uniform sampler2D u_metric;
uniform sampler2D u_film;
uniform sampler2D u_gravity;
uniform vec3 u_down;
uniform float u_strength;
uniform float u_spreading;
#include "tissue/downhill.glsl"
#include "tissue/relief.glsl"
layout(location = 0) out vec4 o_link;  // see blood_part.glsl

ivec2 last;

vec3 position(ivec2 at) {
    return texelFetch(u_position, clamp(at, ivec2(0), last), 0).xyz;
}

bool joined(ivec2 at) {
    return texelFetch(u_film, clamp(at, ivec2(0), last), 0).w != 0.0;
}

/// As in gravity.frag.
vec4 step_along(ivec2 at, ivec2 axis) {
    bool before = joined(at - axis);
    bool after = joined(at + axis);
    ivec2 low = before ? at - axis : at;
    ivec2 high = after ? at + axis : at;
    vec3 way = position(high) - position(low);
    return vec4(way, relief_rise(low, high, way)) * (before && after ? 0.5 : 1.0);
}

void main() {
    vec4 link = texelFetch(u_links, ivec2(gl_FragCoord.xy), 0);
    o_link = vec4(0.0);
    if (link.w == 0.0) {
        return;
    }
    float part = abs(link.w);
    bool from_across = link.w < 0.0;
    last = textureSize(u_position, 0) - 1;
    int width = last.x + 1;
    ivec2 from = ivec2(int(link.x) % width, int(link.x) / width);
    ivec2 to = ivec2(int(link.y) % width, int(link.y) / width);
    int side = int(link.z) & 3;
    ivec2 axis = side < 2 ? ivec2(1 - 2 * side, 0) : ivec2(0, 5 - 2 * side);
    ivec2 along = abs(axis.yx);
    vec4 metric = texelFetch(u_metric, from, 0);
    float sine = sqrt(max(1.0 - metric.z * metric.z, 0.0025));
    float ratio = clamp(max(metric.y, 1e-12) / max(metric.x, 1e-12), 1e-3, 1e3);
    float conductance = (side < 2 ? ratio : 1.0 / ratio) / sine;
    float skew = -metric.z / sine * float(axis.x + axis.y);
    vec3 here = position(from);
    vec4 across = step_along(from, along);
    vec3 over = position(from + axis) - here;
    float n = 0.5 * (max(-dot(u_down, texelFetch(u_normal, from, 0).xyz), u_spreading) +
                     max(-dot(u_down, texelFetch(u_normal, to, 0).xyz), u_spreading));
    float drive = conductance * (dot(u_down, over) - relief_rise(from, from + axis, over)) + skew * (dot(u_down, across.xyz) - across.w);
    float area = min(texelFetch(u_film, from, 0).w, texelFetch(u_film, to, 0).w);
    // As between neighbours (gravity.frag).
#ifdef RELIEF
    float factor;
    float scale;
    vec2 flow = abs(flow_downhill(u_down, step_along(from, ivec2(1, 0)).xyz, step_along(from, ivec2(0, 1)).xyz, vec2(0.0), factor, scale));
#else
    vec2 flow = abs(texelFetch(u_gravity, from, 0).xy);
#endif
    float sum = flow.x + flow.y;
    float share = sum > 0.0 ? 0.4 + 2.4 * (side < 2 ? flow.x : flow.y) / sum : 1.0;
    // Seen from the other side everything is the same but the sign.
    o_link = vec4(part * u_strength * vec2(conductance * n, from_across ? -drive : drive), area > 0.0 ? part * share * area : 0.0,
                  number_of_part(from_across ? from : to, link.z > 3.5));
}

#version 330 core
#include "tissue/blood_part.glsl"
#include "tissue/list.glsl"
// What drives a film through the parts of seams: all links between a cell and one across. A link joins them as if they were neighbours; its
// share of their common face is at most one half, since the other side has links of its own there.
uniform sampler2D u_parts;  // first link, how many, cell across, whether it is its cell's last one
uniform sampler2D u_links;  // cell, cell across, side (0 right, 1 left, 2 top, 3 bottom), share (negative: as seen from across)
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
layout(location = 0) out vec4 o_part;  // see blood_part.glsl

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

ivec2 cell_at(float number) {
    int width = last.x + 1;
    return ivec2(int(number) % width, int(number) / width);
}

/// Spread, drive [mm], area [mm^2].
vec3 pull_of(vec4 link) {
    float share_of_face = abs(link.w);
    bool from_across = link.w < 0.0;
    ivec2 from = cell_at(link.x);
    ivec2 to = cell_at(link.y);
    int side = int(link.z);
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
    return share_of_face * vec3(u_strength * conductance * n, u_strength * (from_across ? -drive : drive), area > 0.0 ? share * area : 0.0);
}

void main() {
    vec4 part = texelFetch(u_parts, ivec2(gl_FragCoord.xy), 0);
    last = textureSize(u_position, 0) - 1;
    vec3 sum = vec3(0.0);
    int link = int(part.x);
    int end = link + int(part.y);
    while (link < end) {
        sum += pull_of(list_item(u_links, link));
        ++link;
    }
    o_part = vec4(sum, number_of_part(cell_at(part.z), part.w > 0.5));
}

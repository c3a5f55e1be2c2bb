#version 330 core
#include "tissue/blood_held.glsl"
#include "tissue/list.glsl"
// The plan: blocks that blood may reach within their chart, and those that it may reach across seams.
uniform sampler2D u_near;   // of blood_near.frag
uniform sampler2D u_reach;  // of tiles: to be stepped
uniform sampler2D u_first;  // of each block: where its pairs begin, and how many there are
uniform sampler2D u_pairs;  // a block across: x, y; kind, see least_of()
layout(location = 0) out vec2 o_plan;  // see blood_plan.glsl

/// How near blood must be to the other block: gutters show all that is stepped across their seam, a film crosses it from where it lies,
/// and goes on beyond if it runs far.
float least_of(float kind) {
    return kind < 0.5 ? may_come : kind < 1.5 ? lies_there : runs_far;
}

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    vec2 near = texelFetch(u_near, block, 0).rg;
    vec2 pairs = texelFetch(u_first, block, 0).rg;
    bool awake = texelFetch(u_reach, block / 4, 0).r > 0.5;
    int i = int(pairs.x);
    int end = awake && near.r < 0.5 ? i + int(pairs.y) : i;
    bool comes = false;
    while (i < end) {
        vec4 pair = list_item(u_pairs, i);
        comes = texelFetch(u_near, ivec2(pair.xy), 0).r > least_of(pair.z) - 0.1;
        i = comes ? end : i + 1;
    }
    o_plan = vec2(comes ? 1.0 : near.r, near.g);
}

#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_held.glsl"
#include "tissue/blood_plan.glsl"
#include "tissue/list.glsl"
// The plan: blocks that blood may reach within their chart, those that it may reach across seams, and those whose gutters show any of them.
uniform sampler2D u_near;   // of blood_near.frag
uniform sampler2D u_reach;  // of tiles: to be stepped
uniform sampler2D u_first;  // of each block: where its pairs begin, and how many items there are
uniform sampler2D u_pairs;  // four pairs an item: the kind of pair, x << 3, y << 12 of the block across
layout(location = 0) out vec2 o_plan;  // see blood_plan.glsl

const int kind_reach = 3;    // a film crosses from where it lies: 1; and goes on beyond if it runs far: 2
const int kind_gutters = 4;  // gutters show all that is stepped there

/// What a pair makes of the plan.
float plan_of(int pair) {
    float near = texel_at(u_near, ivec2((pair >> 3) & 511, pair >> 12)).r;
    int reach = pair & kind_reach;
    bool comes = reach > 0 && near > (reach == 1 ? lies_there : runs_far) - 0.1;
    return comes ? 1.0 : (pair & kind_gutters) != 0 && near > may_come - 0.1 ? plan_gutters : 0.0;
}

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    vec2 near = texel_at(u_near, block).rg;
    vec2 pairs = texel_at(u_first, block).rg;
    bool awake = texel_at(u_reach, block / 4).r > 0.5;
    int i = int(pairs.x);
    int end = awake && near.r < 0.5 ? i + int(pairs.y) : i;
    float plan = near.r;
    // See across_seams() in blood_film.frag.
    do {
        ivec4 four = ivec4(list_item(u_pairs, i));
        float found = max(max(plan_of(four.x), plan_of(four.y)), max(plan_of(four.z), plan_of(four.w)));
        plan = i < end ? max(plan, found) : plan;
        ++i;
    } while (i < end && plan < 0.5);
    o_plan = vec2(plan, near.g);
}

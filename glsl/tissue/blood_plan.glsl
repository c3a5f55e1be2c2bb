#include "common/texel.glsl"
// Blocks of 8 x 8 texels, the finer grid over the tiles: as many steps as there are texels along a side lie between two looks, and a
// film goes on by a texel per step at most. What blood does not reach stays as it is until the next look.
uniform sampler2D u_plan;  // r: 1 to be stepped, plan_gutters only what its gutters show; g: to be shown

const int block_side = 8;
const float plan_gutters = 0.4;

bool steps_in(ivec2 block) {
    return texel_at(u_plan, block).r > 0.5;
}

/// Whether the film in a texel is stepped.
bool steps_at(ivec2 texel) {
    return steps_in(texel >> 3);
}

/// Of a block's plan: whether it is drawn in each step, if only because its gutters show what is stepped elsewhere.
bool is_drawn(float plan) {
    return plan > 0.5 * plan_gutters;
}

bool is_drawn_in(ivec2 block) {
    return is_drawn(texel_at(u_plan, block).r);
}

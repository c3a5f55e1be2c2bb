#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_plan.glsl"
#include "tissue/blood_ground.glsl"
#include "tissue/list.glsl"
// A point as large as a block for each block with a surface; those that are not asked for lie outside.
uniform sampler2D u_list;  // blocks: x, y
uniform int u_first;       // of the list
uniform float u_ground_rows;  // of what blood_on_ground.glsl reads
#ifdef SETTLED
uniform sampler2D u_plan_before;
#endif
#ifdef GUTTERS
uniform int u_with_cells;  // from here on blocks have none
#endif
#ifdef CHANGED
uniform sampler2D u_stepped;  // r: the greatest plan since the picture was drawn
uniform bool u_whole;         // the picture holds nothing yet
uniform int u_stepped_blocks;  // from here on no look tells whether blood is seen
#endif
flat out vec2 v_ground;  // see blood_on_ground.glsl
#ifdef STEP
flat out vec4 v_steps;  // whether the blocks to the left, to the right, below and above are stepped
#endif

void main() {
    ivec2 blocks = textureSize(u_plan, 0);
    int number = u_first + gl_VertexID;
    v_ground = vec2(float(number % blocks_in_row) / float(blocks_in_row), (float(number / blocks_in_row) + 0.5) / u_ground_rows);
    ivec2 block = ivec2(list_item(u_list, number).xy);
    vec2 plan = texel_at(u_plan, block).rg;
#ifdef SETTLED
    // Drawn until now.
    bool drawn = !is_drawn(plan.r) && is_drawn(texel_at(u_plan_before, block).r);
#elif defined(CHANGED)
    float stepped = texel_at(u_stepped, block).r;
    bool drawn = is_drawn(max(stepped, plan.r)) || (u_whole && (plan.g > 0.5 || number >= u_stepped_blocks));
#elif defined(GUTTERS)
    // The others are stepped with their cells.
    bool drawn = is_drawn(plan.r) && (plan.r < 0.5 || number >= u_with_cells);
#else
    bool drawn = plan.r > 0.5;
#endif
#ifdef STEP
    ivec2 low = max(block - 1, ivec2(0));
    ivec2 high = min(block + 1, blocks - 1);
    v_steps = vec4(texel_at(u_plan, ivec2(low.x, block.y)).r, texel_at(u_plan, ivec2(high.x, block.y)).r,
                   texel_at(u_plan, ivec2(block.x, low.y)).r, texel_at(u_plan, ivec2(block.x, high.y)).r);
#endif
    gl_PointSize = float(block_side);
    gl_Position = drawn ? vec4((2.0 * vec2(block) + 1.0) / vec2(blocks) - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}

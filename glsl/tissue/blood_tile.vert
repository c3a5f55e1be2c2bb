#version 330 core
#include "tissue/blood_plan.glsl"
// A point as large as a block for each block; those that are not asked for lie outside. The last ones along a side that is no multiple
// of a block's lie over their neighbours in part, which draws the same there.
uniform vec2 u_size;  // of the target [texels]
#ifdef SETTLED
uniform sampler2D u_plan_before;
#endif
#ifdef CHANGED
uniform sampler2D u_stepped;  // r: stepped since the picture was drawn
uniform bool u_whole;         // the picture holds nothing yet
#endif

void main() {
    ivec2 blocks = textureSize(u_plan, 0);
    ivec2 block = ivec2(gl_VertexID % blocks.x, gl_VertexID / blocks.x);
    vec2 plan = texelFetch(u_plan, block, 0).rg;
#ifdef SETTLED
    // Stepped until now.
    bool drawn = plan.r < 0.5 && texelFetch(u_plan_before, block, 0).r > 0.5;
#elif defined(CHANGED)
    float stepped = texelFetch(u_stepped, block, 0).r;
    bool drawn = max(stepped, plan.r) > 0.5 || (u_whole && plan.g > 0.5);
#else
    bool drawn = plan.r > 0.5;
#endif
    vec2 centre = min((vec2(block) + 0.5) * float(block_side), u_size - 0.5 * float(block_side));
    gl_PointSize = float(block_side);
    gl_Position = drawn ? vec4(2.0 * centre / u_size - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}

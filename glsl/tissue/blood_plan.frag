#version 330 core
#include "tissue/blood_tiles.glsl"
// Which blocks are stepped and shown: those of marked tiles that have blood in reach.
uniform sampler2D u_blocks;  // r: blood or a drop is there; a: no surface is
uniform sampler2D u_beyond;  // r: the same, seen across seams
layout(location = 0) out vec2 o_plan;

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(u_blocks, 0) - 1;
    float reach = 0.0;
    for (int i = 0; i < 9; ++i) {
        ivec2 at = clamp(block + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last);
        reach = max(reach, max(texelFetch(u_blocks, at, 0).r, texelFetch(u_beyond, at, 0).r));
    }
    bool bare = texelFetch(u_blocks, block, 0).a > 0.5;
    o_plan = reach > 0.5 && !bare ? vec2(marks(block / 4)) : vec2(0.0);
}

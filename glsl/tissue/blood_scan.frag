#version 330 core
#include "tissue/blood_held.glsl"
// What has happened in each tile since the last look, from its blocks; tiles that were not stepped are as they were.
uniform sampler2D u_tiles;   // r: something changed or a drop was there; g: blood was there
uniform sampler2D u_reach;   // of blood_reach.frag
uniform sampler2D u_blocks;  // of blood_search.frag
uniform bool u_all;          // whatever shows blood is stepped: it dries, or a tool is at work
layout(location = 0) out vec2 o_mark;

void main() {
    ivec2 tile = ivec2(gl_FragCoord.xy);
    o_mark = vec2(0.0, texelFetch(u_tiles, tile, 0).g);
    vec2 reach = texelFetch(u_reach, tile, 0).rg;
    if ((u_all ? reach.g : reach.r) > 0.5) {
        ivec2 last = textureSize(u_blocks, 0) - 1;
        vec2 most = vec2(0.0);
        for (int i = 0; i < 16; ++i) {
            vec2 block = texelFetch(u_blocks, min(tile * 4 + ivec2(i % 4, i / 4), last), 0).gb;
            most = max(most, vec2((bits_of(block.x) & is_changed) != 0, block.y));
        }
        o_mark = most;
    }
}

#version 330 core
#include "tissue/blood_tiles.glsl"
// What has happened in each tile since the last look, from its blocks; tiles that were not stepped are as they were.
uniform sampler2D u_blocks;  // of blood_search.frag
uniform bool u_all;          // whatever shows blood is stepped: it dries, or a tool is at work
layout(location = 0) out vec2 o_mark;

void main() {
    ivec2 tile = ivec2(gl_FragCoord.xy);
    o_mark = vec2(0.0, texelFetch(u_tiles, tile, 0).g);
    bvec2 stepped_or_shown = marks(tile);
    if (u_all ? stepped_or_shown.y : stepped_or_shown.x) {
        ivec2 last = textureSize(u_blocks, 0) - 1;
        vec2 most = vec2(0.0);
        for (int i = 0; i < 16; ++i) {
            most = max(most, texelFetch(u_blocks, min(tile * 4 + ivec2(i % 4, i / 4), last), 0).gb);
        }
        o_mark = most;
    }
}

#version 330 core
#include "common/texel.glsl"
#include "tissue/list.glsl"
// Tiles that are marked or have a marked neighbour, within their chart or across a seam: a step cannot reach farther.
uniform sampler2D u_tiles;   // of blood_scan.frag
uniform sampler2D u_first;   // of each tile: where the tiles begin that lie across seams, and how many items they are
uniform sampler2D u_across;  // four tiles an item: x + (y << 9)
layout(location = 0) out vec2 o_reach;  // r: to be stepped, g: to be shown

float mark_of(int tile) {
    return texel_at(u_tiles, ivec2(tile & 511, tile >> 9)).r;
}

void main() {
    ivec2 tile = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(u_tiles, 0) - 1;
    vec2 most = vec2(0.0);
    for (int i = 0; i < 9; ++i) {
        most = max(most, texel_at(u_tiles, clamp(tile + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last)).rg);
    }
    vec2 list = texel_at(u_first, tile).rg;
    int i = int(list.x);
    int end = most.r > 0.5 ? i : i + int(list.y);
    while (i < end) {
        ivec4 four = ivec4(list_item(u_across, i));
        float mark = max(max(mark_of(four.x), mark_of(four.y)), max(mark_of(four.z), mark_of(four.w)));
        most = max(most, vec2(mark));
        i = mark > 0.5 ? end : i + 1;
    }
    o_reach = vec2(greaterThan(most, vec2(0.5)));
}

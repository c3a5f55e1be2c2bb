#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_held.glsl"
// What has happened in each tile since the last look, from its blocks.
uniform sampler2D u_blocks;  // of blood_search.frag and blood_mark.vert
layout(location = 0) out vec2 o_mark;  // r: something has changed or a drop is there; g: blood is there

void main() {
    ivec2 tile = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(u_blocks, 0) - 1;
    o_mark = vec2(0.0);
    for (int i = 0; i < 16; ++i) {
        vec4 block = texel_at(u_blocks, min(tile * 4 + ivec2(i % 4, i / 4), last));
        bool stirs = (bits_of(block.g) & is_changed) != 0 || block.a > 0.5 * drop_comes;
        o_mark = max(o_mark, vec2(stirs, block.b));
    }
}

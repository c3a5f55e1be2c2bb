#version 330 core
// Which blocks are stepped: those of marked tiles that have blood in reach which may flow; and which show blood.
uniform sampler2D u_reach;   // of tiles: of blood_reach.frag
uniform sampler2D u_blocks;  // r: blood that may flow or a drop is there; b: shows blood; a: no surface is
uniform sampler2D u_beyond;  // r: as u_blocks, seen across seams
layout(location = 0) out vec2 o_plan;

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(u_blocks, 0) - 1;
    vec2 near = vec2(0.0);  // flows, shows
    for (int i = 0; i < 9; ++i) {
        ivec2 at = clamp(block + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last);
        vec4 there = texelFetch(u_blocks, at, 0);
        near = max(near, vec2(max(there.r, texelFetch(u_beyond, at, 0).r), there.b));
    }
    bool bare = texelFetch(u_blocks, block, 0).a > 0.5;
    vec2 reach = texelFetch(u_reach, block / 4, 0).rg;
    bool flows = near.x > 0.5 && reach.r > 0.5;
    bool shows = near.y > 0.5 || (near.x > 0.5 && reach.g > 0.5);
    o_plan = bare ? vec2(0.0) : vec2(flows, shows);
}

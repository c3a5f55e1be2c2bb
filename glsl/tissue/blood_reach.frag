#version 330 core
// Tiles that are marked or have a marked neighbour, in each channel: a step cannot reach farther.
uniform sampler2D u_tiles;   // r: something changed or a drop is there; g: blood is there
uniform sampler2D u_across;  // r: the same, seen across seams
layout(location = 0) out vec2 o_reach;  // r: to be stepped, g: to be shown

void main() {
    ivec2 tile = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(u_tiles, 0) - 1;
    vec2 most = vec2(0.0);
    for (int i = 0; i < 9; ++i) {
        ivec2 at = clamp(tile + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last);
        most = max(most, max(texelFetch(u_tiles, at, 0).rg, vec2(texelFetch(u_across, at, 0).r)));
    }
    o_reach = vec2(greaterThan(most, vec2(0.5)));
}

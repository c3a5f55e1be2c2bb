#version 330 core
#include "tissue/blood_tiles.glsl"
// What has happened in each tile since the last look: the tiles around those that were stepped are searched, the others are as they were.
uniform sampler2D u_film;
uniform sampler2D u_film_before;  // one step ago
uniform float u_still;            // a change per step below which a film stands [mm]
uniform bool u_all;               // whatever shows blood is stepped: it dries, or a tool is at work
layout(location = 0) out vec2 o_mark;

void main() {
    ivec2 tile = ivec2(gl_FragCoord.xy);
    o_mark = vec2(0.0, texelFetch(u_tiles, tile, 0).g);
    if (marked(tile, u_all)) {
        ivec2 size = textureSize(u_film, 0);
        float change = 0.0;
        float most = 0.0;
        for (int y = 0; y < tile_side; ++y) {
            for (int x = 0; x < tile_side; ++x) {
                ivec2 at = min(tile * tile_side + ivec2(x, y), size - 1);
                vec4 now = texelFetch(u_film, at, 0);
                vec4 before = texelFetch(u_film_before, at, 0);
                most = max(most, now.x + now.y);
                change = max(change, abs((now.x - before.x) + (now.y - before.y)));
            }
        }
        bool shows = most > 0.0;
        o_mark = vec2(change > u_still || (u_all && shows) ? 1.0 : 0.0, shows ? 1.0 : 0.0);
    }
}

#version 330 core
#include "tissue/blood_plan.glsl"
// What has happened in each block since the last look: those that were stepped are searched, the others are as they were.
uniform sampler2D u_blocks;
uniform sampler2D u_film;
uniform sampler2D u_film_before;  // one step ago
uniform float u_still;            // a change per step below which a film stands [mm]
uniform bool u_all;               // whatever shows blood is stepped: it dries, or a tool is at work
uniform bool u_wake;              // the surface is another
uniform float u_rest;             // thickness that does not flow [mm]
layout(location = 0) out vec4 o_block;  // holds blood that may flow, or owes some; something changed; shows blood; has no surface

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    vec4 before_all = texelFetch(u_blocks, block, 0);
    float change = 0.0;
    float most = 0.0;
    float held = 0.0;
    float surface = 0.0;
    bool stepped = texelFetch(u_plan, block, 0).r > 0.5;
    ivec2 last = textureSize(u_film, 0) - 1;
    int count = stepped ? block_side * block_side : 0;
    for (int i = 0; i < count; ++i) {
        ivec2 at = min(block * block_side + ivec2(i % block_side, i / block_side), last);
        vec4 film = texelFetch(u_film, at, 0);
        vec2 now = film.xy;
        surface = max(surface, abs(film.w));
        vec2 before = texelFetch(u_film_before, at, 0).xy;
        most = max(most, now.x + now.y);
        float flowing = max(max(now.x, before.x) - u_rest, max(abs(now.y), abs(before.y)));
        held = max(held, u_all ? max(flowing, max(now.x, before.x)) : flowing);
        change = max(change, abs((now.x - before.x) + (now.y - before.y)));
    }
    bool shows = stepped ? most > 0.0 : before_all.b > 0.5;
    bool holds = stepped ? held > 0.0 : (u_all ? before_all.b : before_all.r) > 0.5;
    bool bare = !u_wake && (stepped ? surface == 0.0 : before_all.a > 0.5);
    o_block = vec4(holds, change > u_still || (u_all && shows), shows, bare);
}

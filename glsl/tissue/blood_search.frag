#version 330 core
#include "tissue/blood_plan.glsl"
#include "tissue/blood_held.glsl"
// What has happened in each block since the last look: those that were stepped are searched, the others are as they were.
uniform sampler2D u_blocks;
uniform sampler2D u_film;
uniform sampler2D u_film_before;  // one step ago
uniform float u_still;            // a change per step below which a film stands [mm]
uniform bool u_all;               // whatever shows blood is stepped: it dries, or a tool is at work
uniform float u_rest;             // thickness that does not flow [mm]
uniform float u_run;              // how far a film runs down a wall until the next look, over its height squared [1/mm]
layout(location = 0) out vec3 o_block;  // see blood_held.glsl; something changed; shows blood

/// How far a film of a height [mm] may run until the next look [texels], in cells of an area [mm^2]: twice as far as its waves do, for
/// cells that are longer than wide, and as steep as its own edge.
float run_of(float height, float area) {
    float side = sqrt(area);
    return 2.0 + 2.0 * u_run * height * height * (1.0 + height / side) / side;
}

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    vec4 before_all = texelFetch(u_blocks, block, 0);
    float change = 0.0;
    float most = 0.0;
    float held = 0.0;
    float longest = 0.0;
    vec4 beyond = vec4(0.0);  // how far blood may go past the left, right, lower and upper edge [texels]
    bool stepped = steps_in(block);
    ivec2 last = textureSize(u_film, 0) - 1;
    int count = stepped ? block_side * block_side : 0;
    for (int i = 0; i < count; ++i) {
        ivec2 in_block = ivec2(i & (block_side - 1), i / block_side);
        ivec2 at = min(block * block_side + in_block, last);
        vec4 film = texelFetch(u_film, at, 0);
        vec2 now = film.xy;
        vec2 before = texelFetch(u_film_before, at, 0).xy;
        most = max(most, now.x + now.y);
        change = max(change, abs((now.x - before.x) + (now.y - before.y)));
        // What gutters show flows where it comes from.
        if (film.w > 0.0) {
            float highest = max(now.x, before.x);
            float flowing = max(highest - u_rest, max(abs(now.y), abs(before.y)));
            held = max(held, u_all ? max(flowing, highest) : flowing);
            float height = highest + max(now.y, 0.0) - u_rest;
            float run = height > 0.0 ? run_of(height, film.w) : 0.0;
            longest = max(longest, run);
            beyond = max(beyond, run - vec4(in_block.x, block_side - 1 - in_block.x, in_block.y, block_side - 1 - in_block.y));
        }
    }
    bool shows = stepped ? most > 0.0 : before_all.b > 0.5;
    bvec4 past = greaterThan(beyond, vec4(0.0));
    int found = held > 0.0 ? holds_blood + (past.x ? goes_left : 0) + (past.y ? goes_right : 0) + (past.z ? goes_down : 0) +
                                 (past.w ? goes_up : 0) + (longest > 4.0 ? goes_far : 0)
                           : 0;
    float holds = stepped ? float(found) / 255.0 : (u_all ? before_all.b : before_all.r);
    o_block = vec3(holds, change > u_still || (u_all && shows), shows);
}

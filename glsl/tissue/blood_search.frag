#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_plan.glsl"
#include "tissue/blood_held.glsl"
// What has happened in each block since the last look: those that were stepped are searched, the others are as they were.
uniform sampler2D u_blocks;
uniform sampler2D u_film;
uniform sampler2D u_film_before;  // one step ago
uniform float u_still;            // a change per step below which a film stands [mm]
uniform bool u_all;               // whatever shows blood is stepped: it dries, or a tool is at work
uniform float u_rest;             // thickness that does not flow [mm]
uniform float u_stirs;            // height up to which no film flows to one as high [mm]: its edges are pinned (blood_common.glsl)
uniform float u_run;              // how far a film runs down a wall until the next look, over its height squared [1/mm]
uniform float u_pinning;
layout(location = 0) out vec4 o_block;  // see blood_held.glsl; what drops do is not known here

/// How far a film of a height [mm] may run until the next look [texels], in cells of an area [mm^2]: twice as far as its waves do, for
/// cells that are longer than wide, and as steep as its own edge.
float run_of(float height, float area) {
    float side = sqrt(area);
    return height > 0.0 ? 2.0 + 2.0 * u_run * height * height * (1.0 + height / side) / side : 0.0;
}

int bits_of_run(float longest, vec4 beyond) {
    bvec4 past = greaterThan(beyond, vec4(0.0));
    return (past.x ? goes_left : 0) + (past.y ? goes_right : 0) + (past.z ? goes_down : 0) + (past.w ? goes_up : 0) +
           (longest > 4.0 ? goes_far : 0);
}

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    vec4 before_all = texel_at(u_blocks, block);
    float change = 0.0;
    float most = 0.0;
    float held = 0.0;
    // How far blood may go, over wet tissue and over dry, and how far past the left, right, lower and upper edge [texels].
    vec2 longest = vec2(0.0);
    vec4 beyond = vec4(0.0);
    vec4 beyond_dry = vec4(0.0);
    bool stepped = is_drawn_in(block);
    ivec2 last = textureSize(u_film, 0) - 1;
    int count = stepped ? block_side * block_side : 0;
    float dry = u_rest + (1.0 - 4.0 * wet_share) * u_pinning;
    for (int i = 0; i < count; ++i) {
        ivec2 in_block = ivec2(i & (block_side - 1), i / block_side);
        ivec2 at = min(block * block_side + in_block, last);
        vec4 film = texel_at(u_film, at);
        vec2 now = film.xy;
        vec2 before = texel_at(u_film_before, at).xy;
        most = max(most, now.x + now.y);
        change = max(change, abs((now.x - before.x) + (now.y - before.y)));
        // What gutters show flows where it comes from.
        if (film.w > 0.0) {
            float highest = max(now.x, before.x);
            // What a height is owed because its digits do not hold it comes to nothing.
            float owed = max(abs(now.y), abs(before.y)) - 6e-8 * highest;
            float flowing = max(highest - u_stirs, owed);
            held = max(held, u_all ? max(flowing, highest) : flowing);
            float height = highest + max(now.y, 0.0);
            // Beside a height that may change the slope does.
            vec2 run = vec2(run_of(height - u_rest, film.w), max(run_of(height - dry, film.w), flowing > 0.0 ? 1.0 : 0.0));
            longest = max(longest, run);
            vec4 to_edge = vec4(in_block.x, block_side - 1 - in_block.x, in_block.y, block_side - 1 - in_block.y);
            beyond = max(beyond, run.x - to_edge);
            beyond_dry = max(beyond_dry, run.y - to_edge);
        }
    }
    bool holds = held > 0.0;
    int found = holds ? holds_blood + bits_of_run(longest.x, beyond) : 0;
    int found_dry = holds ? holds_blood + bits_of_run(longest.y, beyond_dry) : 0;
    float shows = most > wet_share * u_pinning ? is_wet : most > 0.0 ? shows_blood : 0.0;
    if (!stepped) {
        shows = before_all.b;
        found = u_all && shows > 0.5 ? 255 : bits_of(before_all.r);
        found_dry = bits_of(before_all.g) & ~is_changed;
    }
    bool changed = change > u_still || (u_all && shows > 0.5);
    o_block = vec4(float(found) / 255.0, float(found_dry + (changed ? is_changed : 0)) / 255.0, shows, 0.0);
}

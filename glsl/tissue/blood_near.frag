#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_held.glsl"
// Which blocks blood may reach within their chart, in tiles that are stepped; and which show blood.
uniform sampler2D u_reach;    // of tiles: of blood_reach.frag
uniform sampler2D u_blocks;   // see blood_held.glsl
uniform sampler2D u_surface;  // r: there is a surface
layout(location = 0) out vec2 o_near;  // r: see blood_held.glsl; g: to be shown

void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(u_blocks, 0) - 1;
    vec4 here = texel_at(u_blocks, block);
    bool wet = here.b > 0.5 * (shows_blood + is_wet);
    bool flows = false;
    float shown = 0.0;
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
            vec4 there = texel_at(u_blocks, clamp(block + ivec2(x, y), ivec2(0), last));
            int towards = holds_blood + (x < 0 ? goes_right : x > 0 ? goes_left : 0) + (y < 0 ? goes_up : y > 0 ? goes_down : 0);
            flows = flows || (bits_of(wet ? there.r : there.g) & towards) == towards;
            shown = max(shown, there.b);
        }
    }
    float near = flows ? may_come : 0.0;
    near = bits_of(here.r) != 0 || here.a > 0.5 * drop_comes ? lies_there : near;
    near = (bits_of(here.g) & goes_far) != 0 || here.a > 0.5 * (drop_comes + drop_is_there) ? runs_far : near;
    vec2 reach = texel_at(u_reach, block / 4).rg;
    bool bare = texel_at(u_surface, block).r < 0.5;
    bool shows = shown > 0.5 || (near > 0.0 && reach.g > 0.5);
    o_near = bare ? vec2(0.0) : vec2(reach.r > 0.5 ? near : 0.0, shows);
}

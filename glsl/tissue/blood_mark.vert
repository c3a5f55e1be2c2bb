#version 330 core
#include "tissue/list.glsl"
// Marks by points the tiles and blocks in which drops are, or the tiles across seams from marked ones.
#ifdef SEAMS
uniform sampler2D u_pairs;   // one side, other side: x, y each, of tiles that a seam joins
uniform sampler2D u_marked;
#else
#include "tissue/blood_drop.glsl"
#include "tissue/blood_held.glsl"
#ifndef PLACES
#include "tissue/drop_ring.glsl"
#endif
uniform sampler2D u_drops;  // with PLACES: a list of drops to come, each as large as the place where it may
uniform sampler2D u_metric;
uniform ivec2 u_tile_count;
uniform vec2 u_film_size;
uniform bool u_blockwise;  // blocks that a drop reaches, not the tile that it is in
uniform sampler2D u_gravity;
uniform vec4 u_flow;
uniform float u_strength;
uniform float u_steps;  // until drops are marked again
#endif
flat out float v_mark;

void main() {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
    v_mark = 1.0;
#ifdef SEAMS
    vec4 pair = list_item(u_pairs, gl_VertexID);
    ivec2 last = textureSize(u_marked, 0) - 1;
    float most = 0.0;
    for (int i = 0; i < 9; ++i) {
        most = max(most, texelFetch(u_marked, clamp(ivec2(pair.xy) + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last), 0).r);
    }
    if (most > 0.5) {
        gl_Position = vec4(2.0 * (pair.zw + 0.5) / vec2(textureSize(u_marked, 0)) - 1.0, 0.0, 1.0);
    }
#else
    int number = u_blockwise ? gl_VertexID / 2 : gl_VertexID;
    int part = u_blockwise ? gl_VertexID & 1 : 0;
#ifdef PLACES
    vec4 drop = list_item(u_drops, number);
#else
    vec4 drop = texelFetch(u_drops, drop_texel(drop_place(number)), 0);
#endif
    if (drop.z > 0.0) {
        vec2 at = drop.xy * u_film_size;
        vec2 low = floor(at / 32.0);
        vec2 high = low;
        if (u_blockwise) {
            // Its outline, in which it leaves its trail.
            ivec2 texel = ivec2(clamp(at, vec2(0.0), u_film_size - 1.0));
            vec4 metric = texelFetch(u_metric, texel, 0);
            float sine = sqrt(max(1.0 - metric.z * metric.z, 0.0025));
            float radius = drop_radius(drop.z);
            vec2 extent = min(radius / (max(metric.xy, vec2(1e-12)) * sine) + 1.0, vec2(48.0));
            vec2 way = vec2(0.0);
            if (part > 0) {
                // And where it may come to before it is marked again, as fast as in blood_move.frag, with the film that it leaves, which
                // goes on by a texel in each step but the first, and a texel beyond, whose slope changes with it.
                vec4 gravity = texelFetch(u_gravity, texel, 0);
                float height = u_drop.x * radius;
                way = gravity.xy * (gravity.z * gravity.w * u_flow.x * (1.0 / 3.0) * height * height * u_strength * u_flow.z) * u_film_size;
                way *= u_steps * min(1.0, 2.0 / max(length(way), 1e-20));
                extent += u_steps - 1.0;
                v_mark = drop_comes;
            }
            low = floor(max(min(at, at + way) - extent, vec2(0.0)) / 8.0);
            high = floor(min(max(at, at + way) + extent, u_film_size - 0.5) / 8.0);
        }
        vec2 count = high - low + 1.0;
        gl_PointSize = max(count.x, count.y);
        gl_Position = vec4((low + high + 1.0) / vec2(u_tile_count) - 1.0, 0.0, 1.0);
    }
#endif
}

#version 330 core
#include "common/texel.glsl"
#include "tissue/list.glsl"
#include "tissue/blood_drop.glsl"
#include "tissue/blood_held.glsl"
#ifndef PLACES
#include "tissue/drop_ring.glsl"
#endif
// Marks the blocks that drops reach, by two points for each drop.
uniform sampler2D u_drops;  // with PLACES: a list of drops to come, each as large as the place where it may, w: radius of its wound [mm]
uniform sampler2D u_metric;
uniform sampler2D u_gravity;
uniform ivec2 u_block_count;
uniform vec2 u_film_size;
uniform vec4 u_flow;
uniform float u_strength;
uniform float u_steps;  // until drops are marked again
flat out float v_mark;
#ifdef ENERGY
uniform sampler2D u_energy;
uniform sampler2D u_film;
uniform float u_sealed;  // energy at which tissue no longer bleeds

// Whether nothing can come: all tissue in which blood_spawn.vert may put a drop is sealed. What lies across a seam it does not look at.
bool is_sealed(vec2 at, vec2 reach) {
    ivec2 low = ivec2(floor(at - reach));
    ivec2 high = ivec2(floor(at + reach));
    bool all_sealed = textureSize(u_energy, 0) == textureSize(u_film, 0);
    for (int y = low.y; all_sealed && y <= high.y; ++y) {
        for (int x = low.x; all_sealed && x <= high.x; ++x) {
            all_sealed = texel_at(u_film, ivec2(x, y)).w > 0.0 && texel_at(u_energy, ivec2(x, y)).r >= u_sealed;
        }
    }
    return all_sealed;
}
#endif

void main() {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
    v_mark = drop_is_there;
    int number = gl_VertexID / 2;
#ifdef PLACES
    vec4 drop = list_item(u_drops, number);
#else
    vec4 drop = texel_at(u_drops, drop_texel(drop_place(number)));
#endif
    if (drop.z > 0.0) {
        // Its outline, in which it leaves its trail.
        vec2 at = drop.xy * u_film_size;
        ivec2 texel = ivec2(clamp(at, vec2(0.0), u_film_size - 1.0));
        vec4 metric = texel_at(u_metric, texel);
        float sine = sqrt(max(1.0 - metric.z * metric.z, 0.0025));
        float radius = drop_radius(drop.z);
        vec2 extent = min(radius / (max(metric.xy, vec2(1e-12)) * sine) + 1.0, vec2(48.0));
#ifdef ENERGY
        if (is_sealed(at, min(drop.w / (max(metric.xy, vec2(1e-12)) * sine), vec2(12.0)))) {
            return;
        }
#endif
        vec2 way = vec2(0.0);
        if ((gl_VertexID & 1) > 0) {
            // And where it may come to before it is marked again, as fast as in blood_move.frag, with the film that it leaves, which
            // goes on by a texel in each step but the first, and a texel beyond, whose slope changes with it.
            vec4 gravity = texel_at(u_gravity, texel);
            float height = u_drop.x * radius;
            way = gravity.xy * (gravity.z * gravity.w * u_flow.x * (1.0 / 3.0) * height * height * u_strength * u_flow.z) * u_film_size;
            way *= u_steps * min(1.0, 2.0 / max(length(way), 1e-20));
            extent += u_steps - 1.0;
            v_mark = drop_comes;
        }
        vec2 low = floor(max(min(at, at + way) - extent, vec2(0.0)) / 8.0);
        vec2 high = floor(min(max(at, at + way) + extent, u_film_size - 0.5) / 8.0);
        vec2 count = high - low + 1.0;
        gl_PointSize = max(count.x, count.y);
        gl_Position = vec4((low + high + 1.0) / vec2(u_block_count) - 1.0, 0.0, 1.0);
    }
}

#version 330 core
// Marks tiles and blocks by points: those in which drops are, or those across seams from marked ones.
#ifdef SEAMS
#include "tissue/list.glsl"
uniform sampler2D u_pairs;   // one side, other side: x, y each, of tiles or blocks that a seam joins; half more: far from it
uniform sampler2D u_marked;
#ifdef BLOCKS
uniform sampler2D u_reach;  // of tiles: to be stepped
#endif
#else
#include "tissue/blood_drop.glsl"
uniform sampler2D u_drops;
uniform sampler2D u_metric;
uniform int u_first;
uniform ivec2 u_tile_count;
uniform vec2 u_film_size;
uniform bool u_blockwise;  // blocks that a drop reaches, not the tile that it is in
#endif

void main() {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = 1.0;
#ifdef SEAMS
    vec4 pair = list_item(u_pairs, gl_VertexID);
#ifdef BLOCKS
    float most = texelFetch(u_marked, ivec2(pair.xy), 0).r;
    // A thin film goes no farther than to the blocks that the seam leads to.
    most = fract(pair.w) > 0.0 && most < 0.9 ? 0.0 : min(most, texelFetch(u_reach, ivec2(pair.zw) / 4, 0).r);
#else
    ivec2 last = textureSize(u_marked, 0) - 1;
    float most = 0.0;
    for (int i = 0; i < 9; ++i) {
        most = max(most, texelFetch(u_marked, clamp(ivec2(pair.xy) + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last), 0).r);
    }
#endif
    if (most > 0.5) {
        gl_Position = vec4(2.0 * (floor(pair.zw) + 0.5) / vec2(textureSize(u_marked, 0)) - 1.0, 0.0, 1.0);
    }
#else
    ivec2 size = textureSize(u_drops, 0);
    int index = (u_first + gl_VertexID) % (size.x * size.y);
    vec4 drop = texelFetch(u_drops, ivec2(index % size.x, index / size.x), 0);
    if (drop.z > 0.0) {
        vec2 at = drop.xy * u_film_size;
        vec2 low = floor(at / 32.0);
        vec2 high = low;
        if (u_blockwise) {
            // Its outline, in which it leaves its trail. A block around it is drawn as well, which has room for the step's two texels.
            vec4 metric = texelFetch(u_metric, ivec2(clamp(at, vec2(0.0), u_film_size - 1.0)), 0);
            float sine = sqrt(max(1.0 - metric.z * metric.z, 0.0025));
            vec2 extent = min(drop_radius(drop.z) / (max(metric.xy, vec2(1e-12)) * sine) + 1.0, vec2(48.0));
            low = floor(max(at - extent, vec2(0.0)) / 8.0);
            high = floor(min(at + extent, u_film_size - 0.5) / 8.0);
        }
        vec2 count = high - low + 1.0;
        gl_PointSize = max(count.x, count.y);
        gl_Position = vec4((low + high + 1.0) / vec2(u_tile_count) - 1.0, 0.0, 1.0);
    }
#endif
}

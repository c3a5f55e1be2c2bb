#version 330 core
// Marks tiles by points: those in which drops are, or those across seams from marked ones.
#ifdef SEAMS
#include "tissue/blood_tiles.glsl"
uniform sampler2D u_links;
uniform ivec2 u_film_size;
#else
uniform sampler2D u_drops;
uniform int u_first;
uniform ivec2 u_tile_count;
uniform vec2 u_film_size;
const int tile_side = 32;
#endif

void main() {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
#ifdef SEAMS
    ivec2 links = textureSize(u_links, 0);
    vec4 link = texelFetch(u_links, ivec2(gl_VertexID % links.x, gl_VertexID / links.x), 0);
    ivec2 from = ivec2(int(link.x) % u_film_size.x, int(link.x) / u_film_size.x) / tile_side;
    ivec2 to = ivec2(int(link.y) % u_film_size.x, int(link.y) / u_film_size.x) / tile_side;
    ivec2 last = textureSize(u_tiles, 0) - 1;
    float most = 0.0;
    for (int i = 0; i < 9; ++i) {
        most = max(most, texelFetch(u_tiles, clamp(from + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last), 0).r);
    }
    if (most > 0.5) {
        gl_Position = vec4(2.0 * (vec2(to) + 0.5) / vec2(last + 1) - 1.0, 0.0, 1.0);
    }
#else
    ivec2 size = textureSize(u_drops, 0);
    int index = (u_first + gl_VertexID) % (size.x * size.y);
    vec4 drop = texelFetch(u_drops, ivec2(index % size.x, index / size.x), 0);
    if (drop.z > 0.0) {
        vec2 tile = floor(drop.xy * u_film_size / float(tile_side));
        gl_Position = vec4(2.0 * (tile + 0.5) / vec2(u_tile_count) - 1.0, 0.0, 1.0);
    }
#endif
}

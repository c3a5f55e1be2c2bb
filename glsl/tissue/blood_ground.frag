#version 330 core
// What the film and its look read of the surface, block by block: 64 texels of a block lie side by side, as close together in memory as
// they are read.
#include "tissue/blood_ground.glsl"
#include "tissue/list.glsl"
#include "tissue/blood_gutter.glsl"
uniform sampler2D u_list;           // blocks: x, y
uniform sampler2D u_film;
uniform sampler2D u_metric;
uniform sampler2D u_right;          // of gutters: where the surface goes on
uniform sampler2D u_first_of_cell;  // at seams: where its parts begin, or -1
layout(location = 0) out vec2 o_lengths;  // of a texel in u and v [mm]
layout(location = 1) out float o_across;  // of gutters: the cell across; of cells at seams: their first part; or -1

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    ivec2 block = ivec2(list_item(u_list, place.y * blocks_in_row + place.x / texels_of_block).xy);
    ivec2 at = 8 * block + ivec2(place.x & 7, (place.x >> 3) & 7);
    ivec2 last = textureSize(u_film, 0) - 1;
    float kind = all(lessThanEqual(at, last)) ? texelFetch(u_film, min(at, last), 0).w : 0.0;
    o_lengths = max(texelFetch(u_metric, min(at, last), 0).xy, vec2(1e-12));
    float number = number_of_cell(clamp(cell_across(texelFetch(u_right, min(at, last), 0)), ivec2(0), last));
    o_across = kind < 0.0 ? number : kind > 0.0 ? texelFetch(u_first_of_cell, min(at, last), 0).r : -1.0;
}

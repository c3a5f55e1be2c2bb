#version 330 core
// A point as large as a tile for each one that is cast. Nothing of a ray is computed for the others: a branch or a discard in
// the ray caster's own shader would not save that on software renderers.
#include "volume/mixed_choice.glsl"
uniform ivec2 u_size;  // [pixels]

void main() {
    ivec2 tiles = textureSize(u_plan, 0);
    ivec2 tile = ivec2(gl_VertexID % tiles.x, gl_VertexID / tiles.x);
    // Points whose middle is outside the picture are not drawn: where the last tile reaches beyond the border, it is moved,
    // and its pixels that belong to its neighbours are left out by the ray caster.
    vec2 middle = min(vec2(tile * tile_size) + 0.5 * float(tile_size), vec2(u_size));
    gl_PointSize = float(tile_size);
    gl_Position = is_cast(tile * tile_size) ? vec4(2.0 * middle / vec2(u_size) - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}

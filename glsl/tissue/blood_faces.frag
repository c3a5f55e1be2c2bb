#version 330 core
#include "tissue/list.glsl"
#include "tissue/blood_ground.glsl"
// What drives a film through the faces of cells, block by block as in blood_ground.frag: of each of its squares 5 x 4 right faces, from those
// of the cells on its left, and 4 x 5 top faces, from those of the cells below.
uniform sampler2D u_list;  // blocks: x, y
uniform sampler2D u_right;
uniform sampler2D u_top;
layout(location = 0) out vec4 o_face;

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    ivec2 block = ivec2(list_item(u_list, place.y * blocks_in_row + place.x / faces_of_block).xy);
    int square = place.x % faces_of_block / faces_of_square;
    int i = place.x % faces_of_square;
    bool right = i < right_faces;
    int j = i - right_faces;
    ivec2 in_square = right ? ivec2(i % 5 - 1, i / 5) : ivec2(j % faces_of_row, j / faces_of_row - 1);
    ivec2 at = 8 * block + 4 * ivec2(square & 1, square >> 1) + in_square;
    ivec2 last = textureSize(u_right, 0) - 1;
    bool inside = at == clamp(at, ivec2(0), last);
    at = clamp(at, ivec2(0), last);
    vec4 face = right ? texelFetch(u_right, at, 0) : texelFetch(u_top, at, 0);
    o_face = inside ? face : vec4(0.0);
}

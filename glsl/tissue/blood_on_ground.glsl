#include "tissue/blood_ground.glsl"
// Where the textures of blood_ground.frag and blood_faces.frag hold what belongs to the block that is drawn: from where in each row, and in
// which row. Rows of all are as many and hold as many blocks.
flat in vec2 v_ground;

/// Of a texel, in the textures of blood_ground.frag.
vec2 on_ground(ivec2 texel) {
    int i = (texel.x & 7) + ((texel.y & 7) << 3);
    return v_ground + vec2((float(i) + 0.5) / float(blocks_in_row * texels_of_block), 0.0);
}

// From one face to the next in the texture of blood_faces.frag.
const float next_face = 1.0 / float(blocks_in_row * faces_of_block);

/// Of a texel's right and top face in the texture of blood_faces.frag: x of each, and y. The left face is the one before the right one, the
/// bottom one lies faces_of_row before the top one.
vec3 faces_on_ground(ivec2 texel) {
    int square = faces_of_square * ((texel.x >> 2 & 1) + (texel.y >> 1 & 2));
    ivec2 in_square = texel & 3;
    vec2 face = vec2(ivec2(in_square.x + 1 + 5 * in_square.y, right_faces + in_square.x + faces_of_row * (in_square.y + 1)) + square);
    return vec3(v_ground.x + (face + 0.5) * next_face, v_ground.y);
}

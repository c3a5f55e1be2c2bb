#include "tissue/blood_ground.glsl"
flat in ivec2 v_ground;  // the block that is drawn: which in its row, and the row

/// Where a texel lies in the textures of blood_ground.frag.
ivec2 on_ground(ivec2 texel) {
    return ivec2((v_ground.x << 6) + (texel.x & 7) + ((texel.y & 7) << 3), v_ground.y);
}

/// Where its right and its top face lie in the texture of blood_faces.frag. The left one is the one before, the bottom one 8 before.
ivec2 right_on_ground(ivec2 texel) {
    return ivec2(v_ground.x * faces_of_block + (texel.x & 7) + 1 + 9 * (texel.y & 7), v_ground.y);
}

ivec2 top_on_ground(ivec2 texel) {
    return ivec2(v_ground.x * faces_of_block + right_faces + (texel.x & 7) + 8 * (texel.y & 7) + 8, v_ground.y);
}

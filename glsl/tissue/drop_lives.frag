#version 330 core
#include "common/texel.glsl"
#include "tissue/drop_ring.glsl"
// Which drops of each group of the ring live: a bit for each, in two bytes. Both textures are asked: what died in the last step is still
// in the one before.
uniform sampler2D u_drops;
uniform sampler2D u_drops_before;
layout(location = 0) out vec2 o_lives;

void main() {
    int group = group_at(ivec2(gl_FragCoord.xy));
    ivec2 lives = ivec2(0);
    for (int i = 0; i < 16; ++i) {
        ivec2 at = drop_texel(16 * group + i);
        if (max(texel_at(u_drops, at).z, texel_at(u_drops_before, at).z) > 0.0) {
            lives[i >> 3] |= 1 << (i & 7);
        }
    }
    o_lives = vec2(lives) / 255.0;
}

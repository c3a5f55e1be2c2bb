#version 330 core
#include "tissue/drop_ring.glsl"
// Whether a drop lives in each group of the ring. Both textures are asked: what died in the last step is still in the one before.
uniform sampler2D u_drops;
uniform sampler2D u_drops_before;
layout(location = 0) out float o_lives;

void main() {
    int group = group_at(ivec2(gl_FragCoord.xy));
    float most = 0.0;
    for (int i = 0; i < 16; ++i) {
        ivec2 at = drop_texel(16 * group + i);
        most = max(most, max(texelFetch(u_drops, at, 0).z, texelFetch(u_drops_before, at, 0).z));
    }
    o_lives = most > 0.0 ? 1.0 : 0.0;
}

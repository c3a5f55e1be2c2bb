#version 330 core
// Whether a drop lives in each group of the ring. Both textures are asked: what died in the last step is still in the one before.
uniform sampler2D u_drops;
uniform sampler2D u_drops_before;
layout(location = 0) out float o_lives;

void main() {
    ivec2 corner = 4 * ivec2(gl_FragCoord.xy);
    float most = 0.0;
    for (int i = 0; i < 16; ++i) {
        ivec2 at = corner + ivec2(i & 3, i >> 2);
        most = max(most, max(texelFetch(u_drops, at, 0).z, texelFetch(u_drops_before, at, 0).z));
    }
    o_lives = most > 0.0 ? 1.0 : 0.0;
}

#version 330 core
#include "tissue/blood_tiles.glsl"
// A quad for each tile; those that are not asked for shrink to nothing.
uniform vec2 u_size;  // of the target [texels]
#ifdef SETTLED
uniform sampler2D u_tiles_before;
uniform sampler2D u_across_before;
#endif

void main() {
    ivec2 tiles = textureSize(u_tiles, 0);
    ivec2 tile = ivec2(gl_InstanceID % tiles.x, gl_InstanceID / tiles.x);
#ifdef SETTLED
    // Stepped until now.
    float most = 0.0;
    for (int i = 0; i < 9; ++i) {
        ivec2 at = clamp(tile + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), tiles - 1);
        most = max(most, max(texelFetch(u_tiles_before, at, 0).r, texelFetch(u_across_before, at, 0).r));
    }
    bool drawn = most > 0.5;
#elif defined(VISIBLE)
    bool drawn = marked(tile, true);
#else
    bool drawn = marked(tile, false);
#endif
    vec2 corner = vec2(tile + ivec2(gl_VertexID & 1, gl_VertexID >> 1)) * float(tile_side);
    gl_Position = drawn ? vec4(2.0 * corner / u_size - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}

// Tiles of texels: which of them must be stepped, and which show blood.
uniform sampler2D u_tiles;   // r: something changed or a drop is there; g: blood is there
uniform sampler2D u_across;  // r: the same, seen across seams

const int tile_side = 32;

/// Whether a tile or one of its neighbours is marked, in each channel; a step cannot reach farther.
bvec2 marks(ivec2 tile) {
    ivec2 last = textureSize(u_tiles, 0) - 1;
    vec2 most = vec2(0.0);
    for (int i = 0; i < 9; ++i) {
        ivec2 at = clamp(tile + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last);
        most = max(most, max(texelFetch(u_tiles, at, 0).rg, vec2(texelFetch(u_across, at, 0).r)));
    }
    return greaterThan(most, vec2(0.5));
}

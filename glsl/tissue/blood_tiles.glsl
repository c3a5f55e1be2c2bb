// Tiles of texels: which of them must be stepped, and which show blood.
uniform sampler2D u_tiles;   // r: something changed or a drop is there; g: blood is there
uniform sampler2D u_across;  // r: the same, seen across seams

const int tile_side = 32;

/// Whether a tile or one of its neighbours is marked in a channel; a step cannot reach farther.
bool marked(ivec2 tile, bool visible) {
    ivec2 last = textureSize(u_tiles, 0) - 1;
    float most = 0.0;
    for (int i = 0; i < 9; ++i) {
        ivec2 at = clamp(tile + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), last);
        vec2 mark = texelFetch(u_tiles, at, 0).rg;
        most = max(most, max(visible ? mark.g : mark.r, texelFetch(u_across, at, 0).r));
    }
    return most > 0.5;
}

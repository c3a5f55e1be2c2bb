// Slices of a volume side by side on the layers of an array, each with a border of one texel: effects/volume/atlas.h.
// `size` in voxels; `tiles`: slices beside and above each other on a layer.
#ifdef STORAGE_ATLAS
// First texel of a slice, behind its border, and its layer.
ivec3 atlas_tile(ivec3 size, ivec2 tiles, int slice) {
    int row = slice / tiles.x;
    int layer = row / tiles.y;
    ivec2 tile = ivec2(slice - row * tiles.x, row - layer * tiles.y);
    return ivec3(tile * (size.xy + 2) + 1, layer);
}

vec4 atlas_slice(sampler2DArray atlas, ivec3 size, ivec2 tiles, vec2 place, int slice) {
    ivec3 tile = atlas_tile(size, tiles, clamp(slice, 0, size.z - 1));
    vec2 page = vec2(textureSize(atlas, 0).xy);
    return textureLod(atlas, vec3((vec2(tile.xy) + place) / page, float(tile.z)), 0.0);
}

// Trilinear, by the texture unit within slices; beyond the outermost centres their value goes on.
vec4 linear_in_atlas(sampler2DArray atlas, ivec3 size, ivec2 tiles, vec3 place, bool ring) {
    vec3 p = place * vec3(size);
    // The border around each slice takes what rounding moves beyond the outermost centres.
    vec2 inside = clamp(p.xy, vec2(0.5), vec2(size.xy) - 0.5);
#ifdef COORDINATES
    // A ring's border holds the other end.
    float count = float(size.ANGLE);
    inside.ANGLE = ring ? p.ANGLE - count * floor(p.ANGLE / count) : inside.ANGLE;
#endif
    float below = floor(p.z - 0.5);
    vec4 low = atlas_slice(atlas, size, tiles, inside, int(below));
    vec4 high = atlas_slice(atlas, size, tiles, inside, int(below) + 1);
    return low + (p.z - 0.5 - below) * (high - low);
}
#endif

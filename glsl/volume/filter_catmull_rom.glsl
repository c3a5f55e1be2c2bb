// Catmull-Rom from 27 trilinear fetches. Only the two middle weights have one sign and may merge: a fetch between two
// voxels of negative and positive weight would land outside them.

// Three fetches along x; the middle one takes what the weights leave of 1.
VOXEL catmull_rom_line(vec3 x, vec2 w, vec2 yz) {
    VOXEL middle = linear_voxel(vec3(x.y, yz));
    return middle + (w.x * (linear_voxel(vec3(x.x, yz)) - middle) + w.y * (linear_voxel(vec3(x.z, yz)) - middle));
}

VOXEL catmull_rom_plane(vec3 x, vec2 wx, vec3 y, vec2 wy, float z) {
    VOXEL middle = catmull_rom_line(x, wx, vec2(y.y, z));
    return middle + (wy.x * (catmull_rom_line(x, wx, vec2(y.x, z)) - middle) +
                     wy.y * (catmull_rom_line(x, wx, vec2(y.z, z)) - middle));
}

VOXEL SAMPLE(vec3 place) {
    vec3 size = vec3(volume_size());
    vec3 p = place * size - 0.5;
    vec3 cell = floor(p);
    Cubic w = cubic_weights(p - cell);
    vec3 before = (cell - 0.5) / size;
    vec3 between = (cell + 0.5 + w.w2 / (w.w1 + w.w2)) / size;
    vec3 behind = (cell + 2.5) / size;
    vec3 x = vec3(before.x, between.x, behind.x);
    vec3 y = vec3(before.y, between.y, behind.y);
    vec2 wx = vec2(w.w0.x, w.w3.x);
    vec2 wy = vec2(w.w0.y, w.w3.y);
    VOXEL middle = catmull_rom_plane(x, wx, y, wy, between.z);
    return middle + (w.w0.z * (catmull_rom_plane(x, wx, y, wy, before.z) - middle) +
                     w.w3.z * (catmull_rom_plane(x, wx, y, wy, behind.z) - middle));
}

// Along the derivative's axis nothing merges, which would make 108 fetches; 64 voxels give all three at once.
vec3 filter_gradient(vec3 place) {
    return cubic_jet(place).yzw * vec3(volume_size());
}

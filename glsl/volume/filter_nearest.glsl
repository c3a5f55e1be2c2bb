// The voxel that owns the place.
float sample_volume(vec3 place) {
    return texel(inside_volume(ivec3(floor(place * vec3(volume_size())))));
}

vec3 filter_gradient(vec3 place) {
    return vec3(0.0);
}

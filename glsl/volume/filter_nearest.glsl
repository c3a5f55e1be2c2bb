// The voxel that owns the place.
VOXEL SAMPLE(vec3 place) {
    return voxel_at(inside_volume(ivec3(floor(place * vec3(volume_size())))));
}

vec3 filter_gradient(vec3 place) {
    return vec3(0.0);
}

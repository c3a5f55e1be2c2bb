// Tricubic reconstruction from 64 voxels.
float sample_volume(vec3 place) {
    return cubic_jet(place).x;
}

vec3 filter_gradient(vec3 place) {
    return cubic_jet(place).yzw * vec3(volume_size());
}

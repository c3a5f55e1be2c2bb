// Tricubic reconstruction from 64 voxels.
#ifdef COLOURS
vec4 sample_colour(vec3 place) {
    return cubic_colour(place);
}
#else
float sample_volume(vec3 place) {
    return cubic_jet(place).x;
}
#endif

vec3 filter_gradient(vec3 place) {
    return cubic_jet(place).yzw * vec3(volume_size());
}

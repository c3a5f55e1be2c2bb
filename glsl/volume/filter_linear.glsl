// Trilinear reconstruction by the texture unit, whose weights have 8 bits on most GPUs.
VOXEL SAMPLE(vec3 place) {
    return linear_voxel(place);
}

// The derivative along an axis is the difference between the two voxel layers beside the place.
vec3 filter_gradient(vec3 place) {
    vec3 size = vec3(volume_size());
    vec3 low = (floor(place * size - 0.5) + 0.5) / size;
    vec3 high = low + 1.0 / size;
    return size * vec3(linear_texel(vec3(high.x, place.yz)) - linear_texel(vec3(low.x, place.yz)),
                       linear_texel(vec3(place.x, high.y, place.z)) - linear_texel(vec3(place.x, low.y, place.z)),
                       linear_texel(vec3(place.xy, high.z)) - linear_texel(vec3(place.xy, low.z)));
}

// What a place in the volume looks like: colour as it is seen and extinction [1/mm].
vec4 material(vec3 local) {
    return classify(sample_volume(to_sample(local)));
}

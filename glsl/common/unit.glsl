// A vector that may have no length.
vec3 unit(vec3 v) {
    return v * inversesqrt(max(dot(v, v), 1e-30));
}

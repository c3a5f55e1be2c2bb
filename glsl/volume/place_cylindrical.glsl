// Cylindrical volumes: texture coordinates are radius, angle, height. Behind volume/curvilinear.glsl, which is not
// included here: files are included once, also where the preprocessor then leaves them out.

vec3 to_sample(vec3 local) {
    return vec3(length(local.xy), angle_of(local.xy), local.z) * u_sample_scale + u_sample_offset;
}

// A gradient in sample coordinates as a gradient in the world [value/mm]. About the axis the slope along the angle vanishes
// as fast as the radius does; below the guard both are rounding.
vec3 metric(vec3 gradient, vec3 local) {
    vec3 slope = gradient * u_sample_scale;
    float radius = length(local.xy);
    vec2 outwards = direction_of(local.xy, radius);
    float around = slope.y / max(radius, u_axis_guard);
    return u_metric * vec3(slope.x * outwards + around * vec2(-outwards.y, outwards.x), slope.z);
}

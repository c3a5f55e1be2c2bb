// Spherical volumes: texture coordinates are longitude, latitude, radius. Behind volume/curvilinear.glsl, as
// volume/place_cylindrical.glsl is.

vec3 to_sample(vec3 local) {
    float across = length(local.xy);
    // Latitude from both legs, as the longitude: precise at the equator and at the poles.
    return vec3(angle_of(local.xy), angle_of(vec2(across, local.z)), length(vec2(across, local.z))) * u_sample_scale +
           u_sample_offset;
}

// A gradient in sample coordinates as a gradient in the world [value/mm]. Near the axis the slope along the longitude
// vanishes as fast as the distance to it does, and near the centre the one along the latitude; below the guard all are
// rounding.
vec3 metric(vec3 gradient, vec3 local) {
    vec3 slope = gradient * u_sample_scale;
    float across = length(local.xy);
    float radius = length(vec2(across, local.z));
    vec2 outwards = direction_of(local.xy, across);
    vec2 up = direction_of(vec2(across, local.z), radius);  // cosine and sine of the latitude
    float around = slope.x / max(across, u_axis_guard);
    float north = slope.y / max(radius, u_axis_guard);
    return u_metric * vec3((slope.z * up.x - north * up.y) * outwards + around * vec2(-outwards.y, outwards.x),
                           slope.z * up.y + north * up.x);
}

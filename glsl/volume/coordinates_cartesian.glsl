// Coordinate system of a box: local coordinates are the texture's own. A coordinate system is three functions:
// to_sample, ray_intervals and metric.
uniform vec3 u_box_min;  // crop, in texture coordinates
uniform vec3 u_box_max;
uniform mat3 u_metric;   // gradient per texture coordinate -> gradient per mm in the world

const int max_intervals = 1;

// Where the texture is to be sampled for a place.
vec3 to_sample(vec3 local) {
    return local;
}

// Parts of a ray that lie in the volume, in order; empty ones have x >= y.
vec2 ray_interval(Ray ray, int index) {
    vec3 inverse = reciprocal(ray.direction);
    vec3 a = (u_box_min - ray.origin) * inverse;
    vec3 b = (u_box_max - ray.origin) * inverse;
    // A ray that runs in a face itself belongs to the box, all of it.
    vec3 slack = 1e24 * vec3(lessThan(abs(ray.direction), vec3(1e-30)));
    vec3 enter = min(a, b) - slack;
    vec3 leave = max(a, b) + slack;
    return vec2(max(max(enter.x, enter.y), enter.z), min(min(leave.x, leave.y), leave.z));
}

// A gradient in sample coordinates as a gradient in the world [value/mm].
vec3 metric(vec3 gradient, vec3 local) {
    return u_metric * gradient;
}

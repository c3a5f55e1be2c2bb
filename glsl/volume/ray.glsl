// The ray of a pixel in texture coordinates, parametrised by world length s [mm].
// Its origin lies on a plane through the volume, not in the eye: an eye that is far away would cost the digits that the
// volume needs (spec: accuracy F16). effects/volume/ray_frame.h computes the plane in double precision.
uniform vec2 u_pixel;               // size of a pixel in normalised device coordinates
uniform vec3 u_point[3];            // point on the plane: in the picture's centre, per NDC x, per NDC y
uniform vec3 u_direction[3];        // eye to that point, in texture coordinates
uniform vec3 u_world_direction[3];  // the same in the world [mm]; orthographic: of length 1
uniform vec2 u_near_far;            // planes from there, as shares of the world direction's length

struct Ray {
    vec3 origin;
    vec3 direction;  // texture coordinates per mm
    float near;      // s at the near and far plane [mm]
    float far;
    vec3 world;      // direction in the world, of length 1
    float scale;     // mm of s per mm of depth along the view's axis
};

Ray pixel_ray(vec2 pixel) {
    vec2 ndc = pixel * u_pixel - 1.0;
    vec3 world = u_world_direction[0] + ndc.x * u_world_direction[1] + ndc.y * u_world_direction[2];
    float length_mm = length(world);
    Ray ray;
    ray.origin = u_point[0] + ndc.x * u_point[1] + ndc.y * u_point[2];
    ray.direction = (u_direction[0] + ndc.x * u_direction[1] + ndc.y * u_direction[2]) / length_mm;
    ray.near = u_near_far.x * length_mm;
    ray.far = u_near_far.y * length_mm;
    ray.world = world / length_mm;
    ray.scale = length_mm;
    return ray;
}

// Divides by what may be 0 without making NaN: a ray parallel to a face meets it nowhere near.
vec3 reciprocal(vec3 v) {
    vec3 safe = mix(v, vec3(1e-30), lessThan(abs(v), vec3(1e-30)));
    return 1.0 / safe;
}

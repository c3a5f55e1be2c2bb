// What is in the picture besides the volume: opaque surfaces by their depth, and the picture behind.
#ifdef SURFACE
uniform sampler2D u_depth;
uniform vec4 u_depth_to_share;  // effects/volume/ray_frame.h

// Where the ray meets the opaque surface [mm]. From 1 - depth: far surfaces have depths next to 1, from which that
// difference is exact.
float surface_along(Ray ray, vec2 pixel) {
    float from_far = 1.0 - textureLod(u_depth, 0.5 * u_pixel * pixel, 0.0).r;
    vec4 to = u_depth_to_share;
    float share = (to.x - to.y * from_far) / (to.z * from_far + to.w);
    return from_far > 0.0 ? share * ray.scale : ray.far;
}
#endif

#ifdef BACKGROUND
uniform sampler2D u_background;  // premultiplied by its opacity

vec4 over_background(vec4 colour, vec2 pixel) {
    return colour + (1.0 - colour.a) * textureLod(u_background, 0.5 * u_pixel * pixel, 0.0);
}
#endif

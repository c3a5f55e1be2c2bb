// Where rays enter and leave, from the faces that volume.entry and volume.exit have drawn: local coordinates, and in w
// whether the nearest face is entered (volume.entry) or the farthest is left (volume.exit) through its outside: 1, through
// its inside: -1, no face: 0.
// LIMITS: 1 instead of the box's planes, 2 within them.
uniform sampler2D u_entry;
uniform sampler2D u_exit;

float along(Ray ray, vec3 place) {
    return dot(place - ray.origin, ray.direction) / dot(ray.direction, ray.direction);
}

vec2 limit_interval(Ray ray, vec2 pixel, vec2 interval) {
    vec2 uv = 0.5 * u_pixel * pixel;
    vec4 entry = textureLod(u_entry, uv, 0.0);
    vec4 leave = textureLod(u_exit, uv, 0.0);
    // A ray that first meets a face from inside started inside; one that last meets a face from outside ends inside.
    vec2 limits = vec2(entry.w > 0.0 ? along(ray, entry.xyz) : ray.near, leave.w > 0.0 ? along(ray, leave.xyz) : ray.far);
#if LIMITS == 2
    limits = vec2(max(limits.x, interval.x), min(limits.y, interval.y));
#endif
    return leave.w == 0.0 ? vec2(0.0) : limits;
}

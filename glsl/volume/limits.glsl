// Where rays enter and leave, from the faces that volume.entry and volume.exit have drawn: local coordinates, and in w
// whether the nearest face is entered (volume.entry) or the farthest is left (volume.exit) through its outside: 1, through
// its inside: -1, no face: 0.
// LIMITS: 1 instead of the box's planes, 2 within them. Curvilinear volumes are always within theirs: triangles only lie
// closely around curved faces, so the closed form cuts within what they leave.
// LIMITS_INNER: also where rays leave for the first time and enter for the last time (volume.inner_exit and
// volume.inner_entry): a mesh that is not convex may be passed twice.
uniform sampler2D u_entry;
uniform sampler2D u_exit;
#ifdef LIMITS_INNER
uniform sampler2D u_inner_entry;
uniform sampler2D u_inner_exit;
const int max_passages = 2;
#else
const int max_passages = 1;
#endif

float along(Ray ray, vec3 place) {
    return dot(place - ray.origin, ray.direction) / dot(ray.direction, ray.direction);
}

vec2 limit_interval(Ray ray, vec2 pixel, vec2 interval, int passage) {
    vec2 uv = 0.5 * u_pixel * pixel;
    vec4 entry = textureLod(u_entry, uv, 0.0);
    vec4 leave = textureLod(u_exit, uv, 0.0);
    // A ray that first meets a face from inside started inside; one that last meets a face from outside ends inside.
    vec2 limits = vec2(entry.w > 0.0 ? along(ray, entry.xyz) : ray.near, leave.w > 0.0 ? along(ray, leave.xyz) : ray.far);
#ifdef LIMITS_INNER
    vec4 inner_entry = textureLod(u_inner_entry, uv, 0.0);
    vec4 inner_exit = textureLod(u_inner_exit, uv, 0.0);
    float out_first = inner_exit.w != 0.0 ? along(ray, inner_exit.xyz) : limits.y;
    float in_last = inner_entry.w != 0.0 ? along(ray, inner_entry.xyz) : limits.x;
    // One passage: it is left where the ray leaves for good.
    bool twice = out_first < in_last;
    limits = passage == 0 ? vec2(limits.x, twice ? out_first : limits.y) : vec2(twice ? in_last : limits.y, limits.y);
#endif
#if LIMITS == 2 || defined(COORDINATES)
    limits = vec2(max(limits.x, interval.x), min(limits.y, interval.y));
#endif
    return leave.w == 0.0 ? vec2(0.0) : limits;
}

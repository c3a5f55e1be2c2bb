// Half-spaces that cut what is shown: what has dot(u_clip.xyz, local) + u_clip.w >= 0 stays.
// CLIP: their number.
uniform vec4 u_clip[CLIP];

// The part of a ray's interval that lies in all of them. A plane is met where the ray's height over it is 0; one that the
// ray runs along keeps or drops all of it.
vec2 clip_interval(Ray ray, vec2 interval) {
    for (int i = 0; i < CLIP; ++i) {
        float height = dot(u_clip[i].xyz, ray.origin) + u_clip[i].w;
        float rise = dot(u_clip[i].xyz, ray.direction);
        bool along = abs(rise) < 1e-30;
        float s = -height / (along ? 1.0 : rise);
        interval.x = !along && rise > 0.0 ? max(interval.x, s) : interval.x;
        interval.y = !along && rise < 0.0 ? min(interval.y, s) : interval.y;
        interval.y = along && height < 0.0 ? interval.x : interval.y;
    }
    return interval;
}

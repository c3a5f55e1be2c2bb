#version 330 core
#include "tissue/blood_common.glsl"
// One step of the film. The tiles that are drawn are those in which something can change.
uniform sampler2D u_film;
uniform sampler2D u_right;
uniform sampler2D u_top;
uniform float u_one;
#ifdef TOOLS
#include "tissue/blood_tools.glsl"
#endif
layout(location = 0) out vec4 o_film;

/// Height [mm], and whether the surface goes on there.
vec2 at(ivec2 texel) {
    vec4 film = texelFetch(u_film, texel, 0);
    return vec2(film.x, film.w == 0.0 ? 0.0 : 1.0);
}

float slope(vec2 low, float here, vec2 high) {
    float both = low.y * high.y;
    float difference = (high.y > 0.0 ? high.x : here) - (low.y > 0.0 ? low.x : here);
    return both > 0.0 ? 0.5 * difference : difference;
}

float through(vec4 face, float a, float b, float slope_a, float slope_b) {
    float drive = face.z - face.x * (b - a) - face.y * (0.5 * (slope_a + slope_b));
    return face.w > 0.0 ? exchange(drive, face.x, face.w, a, b) : 0.0;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 film = texelFetch(u_film, here, 0);
    vec4 right = texelFetch(u_right, here, 0);
    if (film.w <= 0.0) {
        // A gutter shows what lies across the seam.
        vec2 across = right.w < 0.0 ? right.xy : vec2(gl_FragCoord.xy - 0.5);
        o_film = vec4(film.w < 0.0 ? texelFetch(u_film, ivec2(across + 0.5), 0).x : 0.0, 0.0, 0.0, film.w);
        return;
    }
    ivec2 last = textureSize(u_film, 0) - 1;
    ivec2 low = max(here - 1, ivec2(0));
    ivec2 high = min(here + 1, last);
    vec4 left = here.x > 0 ? texelFetch(u_right, ivec2(low.x, here.y), 0) : vec4(0.0);
    vec4 bottom = here.y > 0 ? texelFetch(u_top, ivec2(here.x, low.y), 0) : vec4(0.0);
    vec4 top = texelFetch(u_top, here, 0);

    float c = film.x;
    vec4 film_l = texelFetch(u_film, ivec2(low.x, here.y), 0);
    vec4 film_r = texelFetch(u_film, ivec2(high.x, here.y), 0);
    vec4 film_b = texelFetch(u_film, ivec2(here.x, low.y), 0);
    vec4 film_t = texelFetch(u_film, ivec2(here.x, high.y), 0);
    vec2 l = vec2(film_l.x, film_l.w == 0.0 ? 0.0 : 1.0);
    vec2 r = vec2(film_r.x, film_r.w == 0.0 ? 0.0 : 1.0);
    vec2 b = vec2(film_b.x, film_b.w == 0.0 ? 0.0 : 1.0);
    vec2 t = vec2(film_t.x, film_t.w == 0.0 ? 0.0 : 1.0);
    vec2 lb = at(low);
    vec2 rb = at(ivec2(high.x, low.y));
    vec2 lt = at(ivec2(low.x, high.y));
    vec2 rt = at(high);
    float slope_u = slope(l, c, r);
    float slope_v = slope(b, c, t);

    // Beyond an open border there is no height that could hold the film back.
    float out_r = through(right, c, film_r.w > 0.0 ? r.x : c, slope_v, slope(rb, r.x, rt));
    float in_l = through(left, film_l.w > 0.0 ? l.x : c, c, slope(lb, l.x, lt), slope_v);
    float out_t = through(top, c, film_t.w > 0.0 ? t.x : c, slope_u, slope(lt, t.x, rt));
    float in_b = through(bottom, film_b.w > 0.0 ? b.x : c, c, slope(lb, b.x, rb), slope_u);
    float lost = (film_r.w > 0.0 ? 0.0 : out_r) - (film_l.w > 0.0 ? 0.0 : in_l) + (film_t.w > 0.0 ? 0.0 : out_t) -
                 (film_b.w > 0.0 ? 0.0 : in_b);

    float change = ((in_l - out_r) + (in_b - out_t)) / film.w + film.y;
    float removed = min(max(c + change, 0.0), u_flow.z * u_flow.w);
#ifdef TOOLS
    removed = max(removed, taken(here, max(c + change, 0.0)));
#endif
    change -= removed;
    // The part of the change that the height's own digits do not hold is owed to it: else deep pools would swallow thin films.
    // The factor 1 keeps compilers from calculating with real numbers here, in which nothing would be owed.
    float height = c + change;
    float back = height * u_one - c;
    float owed = (c - (height - back) * u_one) + (change - back);
    o_film = vec4(height, owed, film.z + lost / film.w + removed, film.w);
}

#version 330 core
#include "tissue/blood_common.glsl"
// One step of the film. The tiles that are drawn are those in which something can change.
uniform sampler2D u_film;
uniform sampler2D u_right;
uniform sampler2D u_top;
uniform float u_one;
uniform bool u_dries;  // also where it stands
#ifdef SEAMS
#include "tissue/list.glsl"
uniform sampler2D u_seam_parts;  // where a cell's parts of seams begin in u_pulls, or -1
uniform sampler2D u_pulls;       // of blood_link.frag
#endif
#ifdef TOOLS
#include "tissue/blood_tools.glsl"
#endif
layout(location = 0) out vec4 o_film;

/// Height [mm], and whether the surface goes on there: 2 in a cell, 1 in a gutter, 0 not.
vec2 at(ivec2 texel) {
    vec4 film = texelFetch(u_film, texel, 0);
    return vec2(film.x, film.w > 0.0 ? 2.0 : -film.w);
}

float slope(vec2 low, float here, vec2 high) {
    float difference = (high.y > 0.0 ? high.x : here) - (low.y > 0.0 ? low.x : here);
    return low.y * high.y > 0.0 ? 0.5 * difference : difference;
}

float through(vec4 face, float a, float b, float slope_a, float slope_b) {
    float drive = face.z - face.x * (b - a) - face.y * (0.5 * (slope_a + slope_b));
    return face.w > 0.0 ? exchange(drive, face.x, face.w, a, b) : 0.0;
}

#ifdef SEAMS
/// Volume that comes across seams [mm^3].
float across_seams(ivec2 here, float height) {
    int width = textureSize(u_film, 0).x;
    float came = 0.0;
    int part = int(texelFetch(u_seam_parts, here, 0).r);
    bool more = part >= 0;
    while (more) {
        vec4 pull = list_item(u_pulls, part);
        int cell = int(abs(pull.w)) - 1;
        float there = texelFetch(u_film, ivec2(cell % width, cell / width), 0).x;
        came -= pull.z > 0.0 ? exchange(pull.y - pull.x * (there - height), pull.x, pull.z, height, there) : 0.0;
        more = pull.w > 0.0;
        ++part;
    }
    return came;
}
#endif

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 film = texelFetch(u_film, here, 0);
    ivec2 last = textureSize(u_film, 0) - 1;
    ivec2 low = max(here - 1, ivec2(0));
    ivec2 high = min(here + 1, last);
    float c = film.x;
    vec2 l = at(ivec2(low.x, here.y));
    vec2 r = at(ivec2(high.x, here.y));
    vec2 b = at(ivec2(here.x, low.y));
    vec2 t = at(ivec2(here.x, high.y));
    o_film = film;
    // Nothing flows where no height around is above the rest that stays.
    float highest = max(max(max(l.x, r.x), max(b.x, t.x)), c);
    bool flows = film.w > 0.0 && (highest > u_flow.y || film.y != 0.0 || (c > 0.0 && u_dries));
    if (flows) {
        vec4 right = texelFetch(u_right, here, 0);
        vec4 top = texelFetch(u_top, here, 0);
        vec4 left = here.x > 0 ? texelFetch(u_right, ivec2(low.x, here.y), 0) : vec4(0.0);
        vec4 bottom = here.y > 0 ? texelFetch(u_top, ivec2(here.x, low.y), 0) : vec4(0.0);
        vec2 lb = at(low);
        vec2 rb = at(ivec2(high.x, low.y));
        vec2 lt = at(ivec2(low.x, high.y));
        vec2 rt = at(high);
        float slope_u = slope(l, c, r);
        float slope_v = slope(b, c, t);

        // Beyond an open border there is no height that could hold the film back.
        float out_r = through(right, c, r.y > 1.0 ? r.x : c, slope_v, slope(rb, r.x, rt));
        float in_l = through(left, l.y > 1.0 ? l.x : c, c, slope(lb, l.x, lt), slope_v);
        float out_t = through(top, c, t.y > 1.0 ? t.x : c, slope_u, slope(lt, t.x, rt));
        float in_b = through(bottom, b.y > 1.0 ? b.x : c, c, slope(lb, b.x, rb), slope_u);
        float lost = (r.y > 1.0 ? 0.0 : out_r) - (l.y > 1.0 ? 0.0 : in_l) + (t.y > 1.0 ? 0.0 : out_t) - (b.y > 1.0 ? 0.0 : in_b);

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
#ifdef SEAMS
    // A gutter shows what lies across the seam.
    if (film.w < 0.0) {
        vec3 across = texelFetch(u_right, here, 0).xyz;
        ivec2 cell = ivec2(across.xy + 0.5) + ivec2(int(across.z) % 3 - 1, int(across.z) / 3 - 1);
        o_film = vec4(texelFetch(u_film, cell, 0).x, 0.0, 0.0, film.w);
    }
    // What comes across joins the height in the next step.
    float came = across_seams(here, c);
    o_film.y += film.w > 0.0 ? came / film.w : 0.0;
#endif
}

#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_common.glsl"
#include "tissue/blood_relief.glsl"
#include "tissue/blood_plan.glsl"
#include "tissue/blood_on_ground.glsl"
// One step of the film. The blocks that are drawn are those in which something can change.
uniform sampler2D u_film;
uniform sampler2D u_faces;  // of blood_faces.frag
uniform float u_one;
uniform bool u_dries;  // also where it stands
#ifdef SEAMS
#include "tissue/blood_gutter.glsl"
#include "tissue/blood_part.glsl"
#include "tissue/list.glsl"
uniform sampler2D u_across;  // of blood_ground.frag
uniform sampler2D u_pulls;   // of blood_link.frag
#endif
#ifdef TOOLS
#include "tissue/blood_tools.glsl"
#endif
flat in vec4 v_steps;  // whether the blocks to the left, to the right, below and above are stepped
layout(location = 0) out vec4 o_film;
layout(location = 1) out float o_relief;

/// Height [mm], and whether the surface goes on there: 2 in a cell, 1 in a gutter, 0 not. Sampled rather than fetched by texel: what
/// lies beyond the border needs no care, and software renderers sample faster.
vec2 at(vec2 uv) {
    vec4 film = textureLod(u_film, uv, 0.0);
    return vec2(film.x, film.w > 0.0 ? 2.0 : -film.w);
}

vec4 face_at(vec2 place) {
    return textureLod(u_faces, place, 0.0);
}

float slope(vec2 low, float here, vec2 high) {
    float difference = (high.y > 0.0 ? high.x : here) - (low.y > 0.0 ? low.x : here);
    return low.y * high.y > 0.0 ? 0.5 * difference : difference;
}

float through(vec4 face, float a, float b, float slope_a, float slope_b) {
    float drive = face.z - face.x * (b - a) - face.y * (0.5 * (slope_a + slope_b));
    return face.w > 0.0 ? exchange(drive, face.x, face.w, a, b) : 0.0;
}

/// A face beside a block that rests lets nothing pass: what left here would not come there.
vec4 shut(vec4 face, bool at_edge, float steps, vec2 there) {
    return vec4(face.xyz, at_edge && steps < 0.5 && there.y > 1.0 ? 0.0 : face.w);
}

#ifdef SEAMS
/// What comes across seams into a cell in a step [mm^3], and to a gutter the height that lies across [mm]. across: of blood_ground.frag.
float across_seams(float across, bool gutter, float height) {
    bool joined = across >= 0.0 && !gutter;
    float came = 0.0;
    int part = joined ? int(across) : 0;
    bool more;
    // A loop that asks before its first turn runs its body once more on llvmpipe. What is used after one that asks behind it must be
    // carried from turn to turn, as the sum is: lanes that have left are computed on.
    do {
        vec4 pull = list_item(u_pulls, part);
        ivec2 cell = gutter ? cell_of_number(max(across, 0.0)) : cell_of_part(pull);
        float there = texel_at(u_film, cell).x;
        // From a block that rests nothing comes: it would not leave there.
        bool flows = joined && pull.z > 0.0 && steps_at(cell);
        float comes = flows ? exchange(pull.y - pull.x * (there - height), pull.x, pull.z, height, there) : 0.0;
        came = gutter ? there : came - comes;
        more = joined && pull.w > 0.0;
        ++part;
    } while (more);
    return came;
}
#endif

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec2 unit = 1.0 / vec2(textureSize(u_film, 0));
    vec2 uv = gl_FragCoord.xy * unit;
    vec4 film = textureLod(u_film, uv, 0.0);
    vec2 low = uv - unit;
    vec2 high = uv + unit;
    float c = film.x;
    vec2 l = at(vec2(low.x, uv.y));
    vec2 r = at(vec2(high.x, uv.y));
    vec2 b = at(vec2(uv.x, low.y));
    vec2 t = at(vec2(uv.x, high.y));
    o_film = film;
    // Nothing flows where no height around is above the rest that stays.
    float highest = max(max(max(l.x, r.x), max(b.x, t.x)), c);
    bool flows = film.w > 0.0 && (highest > u_flow.y || film.y != 0.0 || (c > 0.0 && u_dries));
    if (flows) {
        ivec2 place = here & (block_side - 1);
        vec3 face = faces_on_ground(here);
        vec4 right = shut(face_at(face.xz), place.x == block_side - 1, v_steps.y, r);
        vec4 top = shut(face_at(face.yz), place.y == block_side - 1, v_steps.w, t);
        vec4 left = shut(face_at(vec2(face.x - next_face, face.z)), place.x == 0, v_steps.x, l);
        vec4 bottom = shut(face_at(vec2(face.y - float(faces_of_row) * next_face, face.z)), place.y == 0, v_steps.z, b);
        vec2 lb = at(low);
        vec2 rb = at(vec2(high.x, low.y));
        vec2 lt = at(vec2(low.x, high.y));
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
    // What comes across joins the height in the next step. A gutter shows what lies there.
    float across = textureLod(u_across, on_ground(here), 0.0).r;
    float came = across_seams(across, film.w < 0.0, c);
    o_film.y += film.w > 0.0 ? came / film.w : 0.0;
    o_film = film.w < 0.0 ? vec4(came, 0.0, 0.0, film.w) : o_film;
#endif
    o_relief = relief_of(o_film);
}

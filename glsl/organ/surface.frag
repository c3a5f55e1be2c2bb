#version 330 core
// An organ or a membrane. Each input is compiled out where there is none. DIFFUSE_MAP, CUT and HINT, where they are defined, are the
// texture coordinates of that picture: the mesh's own for files, the tissue's for targets.
#include "common/unit.glsl"
in vec3 v_place;        // from the mesh's centre, in the eye's axes [mm]
in vec3 v_normal;
in vec2 v_uv;           // texture space of the tissue's targets
in vec2 v_picture_uv;   // of the mesh's own pictures
in float v_scalar;
uniform vec3 u_colour;
uniform vec3 u_pivot_in_eye;   // the mesh's centre [mm]
uniform vec3 u_towards_eye;    // orthographic: against the rays; perspective: 0
uniform vec3 u_specular_colour;
#ifdef DIFFUSE_MAP
uniform sampler2D u_diffuse;
uniform float u_diffuse_repeat;
#endif
#ifdef NORMAL_MAP
uniform sampler2D u_slopes;     // [mm/mm] along the directions of u and v
uniform vec2 u_bump;            // factor on them; how much of it burning adds
uniform float u_bump_repeat;
#endif
#ifdef ENERGY
uniform sampler2D u_energy;
#endif
#ifdef BLOOD
uniform sampler2D u_blood;      // factor on the colour, amount
#endif
#ifdef BLOOD_NORMAL
uniform sampler2D u_blood_normal;
uniform float u_blood_bump;
#endif
#ifdef BLOOD_HEIGHT
uniform sampler2D u_blood_height;  // [mm]
uniform float u_blood_bump;
#endif
#ifdef CUT
uniform sampler2D u_cut;
#endif
#ifdef HINT
uniform sampler2D u_hint;
uniform float u_hint_share;
#endif
#ifdef BLENDED
uniform float u_depth_of_slab;  // -ln(1 - opacity)
layout(location = 0, index = 0) out vec4 o_colour;
layout(location = 0, index = 1) out vec4 o_cover;
#else
layout(location = 0) out vec4 o_colour;
#endif
#if defined(DIFFUSE_MAP) || defined(NORMAL_MAP) || defined(CUT_BY_VERTEX) || defined(HINT)
#include "organ/level.glsl"
#endif
#if defined(NORMAL_MAP) || defined(BLOOD_NORMAL) || defined(BLOOD_HEIGHT)
#define BUMP
#include "organ/bump.glsl"
#endif
#ifdef ENERGY
#include "organ/burn.glsl"
#endif
#ifdef HEMATOMA
#include "organ/hematoma.glsl"
#endif
#ifdef LIGHTS
#include "organ/light.glsl"
#endif
#ifdef FOCUS
#include "organ/focus.glsl"
#endif

// Within what a half holds. What is no number, as a target that a host lends may hold, is black.
vec3 storable(vec3 colour) {
    const float largest = 65504.0;
    return dot(abs(colour), vec3(1.0)) < 1e30 ? clamp(colour, -largest, largest) : vec3(0.0);
}

void main() {
    vec3 in_eye = u_pivot_in_eye + v_place;
    vec3 eye = unit(u_towards_eye == vec3(0.0) ? -in_eye : u_towards_eye);
    float side = gl_FrontFacing ? 1.0 : -1.0;
    vec3 normal = unit(side * v_normal);
    float gloss = 1.0;

    vec4 colour = vec4(u_colour, 1.0);
#ifdef DIFFUSE_MAP
    vec2 diffuse_uv = u_diffuse_repeat * DIFFUSE_MAP;
    colour *= textureLod(u_diffuse, diffuse_uv, level_of(u_diffuse, diffuse_uv));
#endif
#ifdef CUT
#ifdef CUT_BY_VERTEX
    vec4 cut = textureLod(u_cut, CUT, level_of(u_cut, CUT));
    bool is_cut = v_scalar > 0.0;
#else
    // Smaller copies would widen the cut.
    vec4 cut = textureLod(u_cut, CUT, 0.0);
    bool is_cut = cut.a > 0.0;
#endif
    colour.rgb = is_cut ? cut.rgb : colour.rgb;
    float whole = is_cut ? 0.0 : 1.0;
#else
    const float whole = 1.0;
#endif
#ifdef HEMATOMA
#if HEMATOMA == 1
    colour.rgb = bruised(colour.rgb, v_place, gl_FragCoord.xy);
#else
    colour.rgb = bruised(colour.rgb, vec3(v_uv, 0.0), v_uv);
#endif
#endif
#ifdef ENERGY
    Burn burn = burn_of(textureLod(u_energy, v_uv, 0.0).r);
    colour.rgb = burnt(colour.rgb, burn);
    gloss = max(0.05, (1.0 - burn.coagulated) * (1.0 - burn.coagulated));
#endif
#ifdef BLOOD
    vec4 blood = textureLod(u_blood, v_uv, 0.0);
    float wet = clamp(blood.a, 0.0, 1.0) * whole;
    colour.rgb *= mix(vec3(1.0), blood.rgb, whole);
#endif
#ifdef HINT
    vec4 hint = textureLod(u_hint, HINT, level_of(u_hint, HINT));
    colour.rgb = mix(colour.rgb, hint.rgb, u_hint_share * hint.a * whole);
#endif

#ifdef BUMP
    vec3 px = dFdx(v_place);
    vec3 py = dFdy(v_place);
#endif
#ifdef NORMAL_MAP
    float steepness = side * u_bump.x;
#ifdef ENERGY
    steepness *= 1.0 + u_bump.y * burn.coagulated;
#endif
#ifdef BLOOD
    steepness *= 1.0 - 0.5 * wet;
#endif
    vec2 slopes_uv = u_bump_repeat * v_picture_uv;
    vec2 slopes = steepness * textureLod(u_slopes, slopes_uv, level_of(u_slopes, slopes_uv)).rg;
    normal = bumped(normal, px, py, rise_of(slopes, px, py, dFdx(v_picture_uv), dFdy(v_picture_uv)));
#endif
#ifdef BLOOD_NORMAL
    vec2 blood_slopes = side * u_blood_bump * slopes_of(textureLod(u_blood_normal, v_uv, 0.0).xyz);
    normal = bumped(normal, px, py, rise_of(blood_slopes, px, py, dFdx(v_uv), dFdy(v_uv)));
#endif
#ifdef BLOOD_HEIGHT
    vec2 texels = vec2(textureSize(u_blood_height, 0));
    vec2 step_u = vec2(1.0 / texels.x, 0.0);
    vec2 step_v = vec2(0.0, 1.0 / texels.y);
    vec2 rise = vec2(textureLod(u_blood_height, v_uv + step_u, 0.0).r - textureLod(u_blood_height, v_uv - step_u, 0.0).r,
                     textureLod(u_blood_height, v_uv + step_v, 0.0).r - textureLod(u_blood_height, v_uv - step_v, 0.0).r);
    vec2 blood_slopes = side * u_blood_bump * 0.5 * texels * rise;
    normal = bumped(normal, px, py, vec2(dot(blood_slopes, dFdx(v_uv)), dot(blood_slopes, dFdy(v_uv))));
#endif

#ifdef LIGHTS
    Light light = light_at(v_place, normal, eye, gloss);
    vec3 scattered = colour.rgb * light.scattered;
    vec3 added = u_specular_colour * light.mirrored + light.glow;
#else
    vec3 scattered = vec3(0.0);
    vec3 added = vec3(0.0);
#endif
#ifdef FOCUS
    float stored = stored_blurriness(-in_eye.z);
#else
    const float stored = 0.5;
#endif
#ifdef BLENDED
    // The way through a slab is longer the more it is looked at from the side; what shines on it is not seen through it.
    float way = 1.0 / max(abs(dot(unit(v_normal), eye)), 1e-3);
    // Where the map's alpha is 0 there is a hole, on which nothing shines.
    float there = colour.a > 0.0 ? min(colour.a, 1.0) : 0.0;
    float cover = there * (1.0 - exp(-u_depth_of_slab * way));
    o_colour = vec4(storable(scattered * cover + added * there), stored * cover);
    o_cover = vec4(cover);
#else
    o_colour = vec4(storable(scattered + added), stored);
#endif
}

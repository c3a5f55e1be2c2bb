#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_gutter.glsl"
#include "tissue/blood_plan.glsl"
uniform sampler2D u_film;
uniform sampler2D u_right;  // of gutters: where the surface goes on
uniform sampler2D u_position;
flat in vec4 v_cap;      // place [mm], radius [mm]
flat in float v_height;  // in the middle [mm]
layout(location = 0) out float o_height;  // the greatest one stays

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 place = texel_at(u_position, here);
    vec3 away = place.xyz - v_cap.xyz;
    float inside = 1.0 - dot(away, away) / (v_cap.w * v_cap.w);
    // Drops stand on the film, of which gutters that no step reads hold nothing. What is not stepped is not drawn again before the next
    // picture.
    float kind = texel_at(u_film, here).w;
    vec2 film = texel_at(u_film, kind < 0.0 ? cell_across(texel_at(u_right, here)) : here).xy;
    bool drawn = inside > 0.0 && kind != 0.0 && is_drawn_in(here >> 3);
    o_height = drawn ? max(film.x + film.y, 0.0) + v_height * inside : -1.0;
}

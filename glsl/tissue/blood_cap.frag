#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_plan.glsl"
uniform sampler2D u_film;
uniform sampler2D u_position;
flat in vec4 v_cap;      // place [mm], radius [mm]
flat in float v_height;  // in the middle [mm]
layout(location = 0) out float o_height;  // the greatest one stays

void main() {
    vec4 place = texel_at(u_position, ivec2(gl_FragCoord.xy));
    vec3 away = place.xyz - v_cap.xyz;
    float inside = 1.0 - dot(away, away) / (v_cap.w * v_cap.w);
    vec4 film = texel_at(u_film, ivec2(gl_FragCoord.xy));
    // Drops stand on the film. What is not stepped is not drawn again before the next picture.
    bool drawn = inside > 0.0 && film.w != 0.0 && is_drawn_in(ivec2(gl_FragCoord.xy) >> 3);
    o_height = drawn ? max(film.x + film.y, 0.0) + v_height * inside : -1.0;
}

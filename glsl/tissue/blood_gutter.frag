#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_on_ground.glsl"
#include "tissue/blood_gutter.glsl"
#include "tissue/blood_relief.glsl"
// A step of the film where no cell has blood: gutters show what lies across the seam. With CHANGED those that no step reads, for a picture.
uniform sampler2D u_film;    // before the last step
uniform sampler2D u_across;  // of blood_ground.frag
#ifdef CHANGED
layout(location = 0) out float o_relief;
#else
layout(location = 0) out vec4 o_film;
layout(location = 1) out float o_relief;
#endif

void main() {
    vec4 film = texel_at(u_film, ivec2(gl_FragCoord.xy));
    float across = textureLod(u_across, on_ground(ivec2(gl_FragCoord.xy)), 0.0).r;
    float height = texel_at(u_film, cell_of_number(max(across, 0.0))).x;
    film = film.w < 0.0 ? vec4(height, 0.0, 0.0, -1.0) : film;
#ifndef CHANGED
    o_film = film;
#endif
    o_relief = relief_of(film);
}

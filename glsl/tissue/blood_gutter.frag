#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_on_ground.glsl"
#include "tissue/blood_gutter.glsl"
#include "tissue/blood_relief.glsl"
// A step of the film where no cell has blood: gutters show what lies across the seam.
uniform sampler2D u_film;
uniform sampler2D u_across;  // of blood_ground.frag
layout(location = 0) out vec4 o_film;
layout(location = 1) out float o_relief;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 film = texel_at(u_film, here);
    float across = textureLod(u_across, on_ground(here), 0.0).r;
    float height = texel_at(u_film, cell_of_number(max(across, 0.0))).x;
    o_film = film.w < 0.0 ? vec4(height, 0.0, 0.0, -1.0) : film;
    o_relief = relief_of(o_film);
}

#version 330 core
#include "tissue/blood_on_ground.glsl"
#include "tissue/blood_gutter.glsl"
#include "tissue/blood_relief.glsl"
// A step of the film where no cells are: gutters show what lies across the seam.
uniform sampler2D u_film;
uniform sampler2D u_across;  // of blood_ground.frag
layout(location = 0) out vec4 o_film;
layout(location = 1) out float o_relief;

void main() {
    float across = texelFetch(u_across, on_ground(ivec2(gl_FragCoord.xy)), 0).r;
    float height = texelFetch(u_film, cell_of_number(max(across, 0.0)), 0).x;
    o_film = across >= 0.0 ? vec4(height, 0.0, 0.0, -1.0) : vec4(0.0);
    o_relief = relief_of(o_film);
}

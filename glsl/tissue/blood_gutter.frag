#version 330 core
#include "tissue/blood_gutter.glsl"
#include "tissue/blood_relief.glsl"
// A step of the film where no cells are: gutters show what lies across the seam.
uniform sampler2D u_film;
uniform sampler2D u_right;
layout(location = 0) out vec4 o_film;
layout(location = 1) out float o_relief;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float kind = texelFetch(u_film, here, 0).w;
    ivec2 cell = cell_across(texelFetch(u_right, here, 0));
    o_film = vec4(kind < 0.0 ? texelFetch(u_film, max(cell, ivec2(0)), 0).x : 0.0, 0.0, 0.0, kind);
    o_relief = relief_of(o_film);
}

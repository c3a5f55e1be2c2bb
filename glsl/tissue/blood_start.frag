#version 330 core
#include "tissue/blood_relief.glsl"
// The film on a surface that has just come or moved: what lies on a cell keeps its volume as the cell's area changes. Of one that has
// collapsed it waits as a volume until the cell opens again.
uniform sampler2D u_film;
uniform sampler2D u_metric;
uniform sampler2D u_position;
uniform sampler2D u_seam;
uniform bool u_empty;  // nothing was there before
#ifdef SPILL
uniform sampler2D u_spill;  // what lies there at the start [mm]
#endif
layout(location = 0) out vec4 o_film;
layout(location = 1) out float o_relief;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    float coverage = texelFetch(u_position, here, 0).w;
    float area = texelFetch(u_metric, here, 0).w;
    bool cell = coverage > 0.75 && area > 1e-20 && area < 1e20;
    bool gutter = !cell && coverage > 0.25 && coverage < 0.75 && texelFetch(u_seam, here, 0).x >= 0.0;
    vec4 before = texelFetch(u_film, here, 0);
    // What a height stood for, and what it stands for now [mm^2].
    float from = before.w > 0.0 ? before.w : before.w < 0.0 ? 0.0 : 1.0;
    float scale = gutter ? 0.0 : from / (cell ? area : 1.0);
    vec3 start = vec3(0.0);
#ifdef SPILL
    start.x = cell ? clamp(texelFetch(u_spill, ivec2(gl_FragCoord.xy / vec2(textureSize(u_film, 0)) * vec2(textureSize(u_spill, 0))), 0).r, 0.0, 1e4) : 0.0;
#endif
    o_film = vec4(u_empty ? start : scale * before.xyz, cell ? area : gutter ? -1.0 : 0.0);
    o_relief = relief_of(o_film);
}

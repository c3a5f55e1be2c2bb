#version 330 core
#include "common/texel.glsl"
#ifdef SETTLED
#include "tissue/blood_relief.glsl"
layout(location = 1) out float o_relief;
#endif
uniform sampler2D u_film;
layout(location = 0) out vec4 o_film;

void main() {
    o_film = texel_at(u_film, ivec2(gl_FragCoord.xy));
#ifdef SETTLED
    // Without the drops that were drawn there.
    o_relief = relief_of(o_film);
#endif
}

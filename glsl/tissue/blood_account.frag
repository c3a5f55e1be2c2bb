#version 330 core
// Where blood is: each texel adds up its block of the film and its part of the drops.
uniform sampler2D u_film;    // height, owed, gone [mm], area [mm^2]
uniform sampler2D u_drops;   // u, v, volume [mm^3], age
uniform sampler2D u_ledger;  // volume given, by the drops' places [mm^3]
uniform float u_flying;      // volume of jets in the air [mm^3]
uniform float u_lost;        // volume of jets that met nothing [mm^3]
layout(location = 0) out vec4 o_account;  // given, on the surface as film, as drops, gone [mm^3]

const int side = 64;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    int index = at.y * side + at.x;
    o_account = index == 0 ? vec4(u_flying + u_lost, 0.0, u_flying, u_lost) : vec4(0.0);
    ivec2 size = textureSize(u_film, 0);
    ivec2 first = at * size / side;
    ivec2 end = (at + 1) * size / side;
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            vec4 film = texelFetch(u_film, ivec2(x, y), 0);
            // Nothing, or a cell that has collapsed, holds volumes.
            float area = film.w > 0.0 ? film.w : film.w < 0.0 ? 0.0 : 1.0;
            o_account.yw += area * vec2(film.x + film.y, film.z);
        }
    }
    ivec2 ring = textureSize(u_drops, 0);
    int drops = ring.x * ring.y;
    for (int i = index; i < drops; i += side * side) {
        ivec2 place = ivec2(i % ring.x, i / ring.x);
        o_account.z += max(texelFetch(u_drops, place, 0).z, 0.0);
        o_account.x += texelFetch(u_ledger, place, 0).r;
    }
}

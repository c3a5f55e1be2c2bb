#version 330 core
// How high the film stands [mm]; -1 where there is no surface.
uniform sampler2D u_film;
layout(location = 0) out float o_height;

void main() {
    vec4 film = texelFetch(u_film, ivec2(gl_FragCoord.xy), 0);
    o_height = film.w == 0.0 ? -1.0 : max(film.x + film.y, 0.0);
}

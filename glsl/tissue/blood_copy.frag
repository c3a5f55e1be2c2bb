#version 330 core
uniform sampler2D u_film;
layout(location = 0) out vec4 o_film;

void main() {
    o_film = texelFetch(u_film, ivec2(gl_FragCoord.xy), 0);
}

#version 330 core
flat in vec2 v_added;
layout(location = 0) out vec4 o_film;

void main() {
    o_film = vec4(0.0, v_added, 0.0);
}

#version 330 core
flat in vec2 v_added;
layout(location = 0) out vec4 o_film;
layout(location = 1) out float o_relief;

void main() {
    o_film = vec4(0.0, v_added, 0.0);
    o_relief = v_added.x;
}

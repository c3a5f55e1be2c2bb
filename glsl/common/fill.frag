#version 330 core
// One value wherever the depth test lets it through.
uniform vec4 u_value;
layout(location = 0) out vec4 o_value;

void main() {
    o_value = u_value;
}

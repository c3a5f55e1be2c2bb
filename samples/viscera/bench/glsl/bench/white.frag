#version 330 core
layout(location = 0) out vec4 o_value;

void main() {
    o_value = vec4(1.0);
}

#version 330 core
layout(location = 0) out vec2 o_mark;

void main() {
    o_mark = vec2(1.0);
}

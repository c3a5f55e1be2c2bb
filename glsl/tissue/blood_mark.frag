#version 330 core
flat in float v_mark;
layout(location = 0) out vec4 o_mark;

void main() {
    o_mark = vec4(v_mark);
}

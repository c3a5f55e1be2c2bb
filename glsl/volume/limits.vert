#version 330 core
in vec3 a_position;  // local coordinates
uniform mat4 u_to_clip;
out vec3 v_local;

void main() {
    v_local = a_position;
    gl_Position = u_to_clip * vec4(a_position, 1.0);
}

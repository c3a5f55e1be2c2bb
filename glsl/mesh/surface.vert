#version 330 core
in vec3 a_position;  // [mm], the mesh's own frame
in vec3 a_normal;
uniform mat4 u_to_clip;
uniform mat4 u_to_eye;
uniform mat3 u_normal_to_eye;
out vec3 v_place;   // in front of the eye [mm]
out vec3 v_normal;

void main() {
    v_place = (u_to_eye * vec4(a_position, 1.0)).xyz;
    v_normal = u_normal_to_eye * a_normal;
    gl_Position = u_to_clip * vec4(a_position, 1.0);
}

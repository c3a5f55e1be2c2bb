#version 330 core
// Places are counted from the mesh's centre: near it a float holds finer steps, which the bump's derivatives live on.
in vec3 a_position;  // [mm], the mesh's own frame
in vec3 a_normal;
in vec2 a_uv;          // texture space of the tissue's targets
in vec2 a_picture_uv;  // of the mesh's own pictures
in float a_scalar;
uniform mat4 u_to_clip;
uniform mat3 u_turn;            // mesh to eye
uniform mat3 u_normal_to_eye;
uniform vec3 u_pivot;           // the mesh's centre, in its own frame
out vec3 v_place;               // from the mesh's centre, in the eye's axes [mm]
out vec3 v_normal;
out vec2 v_uv;
out vec2 v_picture_uv;
out float v_scalar;

void main() {
    v_place = u_turn * (a_position - u_pivot);
    v_normal = u_normal_to_eye * a_normal;
    v_uv = a_uv;
    v_picture_uv = a_picture_uv;
    v_scalar = a_scalar;
    gl_Position = u_to_clip * vec4(a_position, 1.0);
}

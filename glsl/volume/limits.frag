#version 330 core
// A face of what limits rays, for limits.glsl.
in vec3 v_local;
layout(location = 0) out vec4 o_place;

void main() {
#ifdef EXIT
    o_place = vec4(v_local, gl_FrontFacing ? -1.0 : 1.0);
#else
    o_place = vec4(v_local, gl_FrontFacing ? 1.0 : -1.0);
#endif
}

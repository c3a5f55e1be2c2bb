#version 330 core
// One triangle that covers the target: no vertex buffer, no diagonal along which pixels are shaded twice. FAR: as far as can be.
out vec2 v_uv;

void main() {
    vec2 corner = vec2(float((gl_VertexID << 1) & 2), float(gl_VertexID & 2));
    v_uv = corner;
#ifdef FAR
    const float depth = 1.0;
#else
    const float depth = 0.0;
#endif
    gl_Position = vec4(2.0 * corner - 1.0, depth, 1.0);
}

#version 330 core
// Right triangles with legs of a pixel, in rows; with HIDDEN beside the view, so that nothing but vertices is left.
uniform vec2 u_target_size;  // [pixels]
const int columns = 512;

void main() {
    int triangle = gl_VertexID / 3;
    int corner = gl_VertexID - 3 * triangle;
    vec2 pixel = vec2(float(triangle % columns), float((triangle / columns) % columns)) + vec2(float(corner & 1), float(corner >> 1));
#ifdef HIDDEN
    pixel += 2.0 * u_target_size;
#endif
    gl_Position = vec4(2.0 * pixel / u_target_size - 1.0, 0.0, 1.0);
}

#version 330 core
#include "tissue/blood_plan.glsl"
// A point for each chunk of cells at seams, as large as the chunk; those whose block is not stepped lie outside.
uniform sampler2D u_cells;  // of blood_seam.frag
uniform vec2 u_size;        // of the target

const int side = 4;

void main() {
    ivec2 corner = side * ivec2(gl_VertexID & 255, gl_VertexID >> 8);
    gl_PointSize = float(side);
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    if (steps_at(ivec2(texelFetch(u_cells, corner, 0).xy))) {
        gl_Position = vec4(2.0 * (vec2(corner) + 0.5 * float(side)) / u_size - 1.0, 0.0, 1.0);
    }
}

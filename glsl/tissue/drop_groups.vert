#version 330 core
#include "tissue/drop_ring.glsl"
// A point for each group of drops that may live.
uniform vec2 u_size;  // of the ring's texture

void main() {
    gl_PointSize = float(group_side);
    gl_Position = vec4((2.0 * vec2(group_texel(listed_group(gl_VertexID))) + float(group_side)) / u_size - 1.0, 0.0, 1.0);
}

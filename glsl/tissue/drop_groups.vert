#version 330 core
#include "tissue/drop_ring.glsl"
// A point for each group in which a drop may live.
uniform sampler2D u_groups;  // their numbers
uniform vec2 u_size;  // of the ring's texture

void main() {
    gl_PointSize = float(group_side);
    gl_Position = vec4((2.0 * vec2(group_texel(int(list_item(u_groups, gl_VertexID).x))) + float(group_side)) / u_size - 1.0, 0.0, 1.0);
}

#version 330 core
#include "tissue/drop_ring.glsl"
// A point for each group in which a drop may live.
uniform sampler2D u_groups;  // their numbers
uniform vec2 u_size;  // of the texture that is drawn into
uniform int u_side;   // of a group there: as long as in the ring's texture, or a texel

void main() {
    int group = int(list_item(u_groups, gl_VertexID).x);
    gl_PointSize = float(u_side);
    gl_Position = vec4(float(u_side) * (2.0 * vec2(group_place(group)) + 1.0) / u_size - 1.0, 0.0, 1.0);
}

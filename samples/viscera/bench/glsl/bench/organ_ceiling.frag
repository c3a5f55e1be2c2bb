#version 330 core
// In place of an organ's shader: what is left is the mesh, the depth test and what is written.
out vec4 o_colour;

void main() {
    o_colour = vec4(0.44, 0.13, 0.1, 0.5);
}

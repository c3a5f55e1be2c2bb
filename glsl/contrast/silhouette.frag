#version 330 core
// Where a mesh is seen at all.
layout(location = 0) out float o_mask;

void main() {
    o_mask = 1.0;
}

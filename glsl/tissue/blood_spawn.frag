#version 330 core
flat in vec4 v_drop;
layout(location = 0) out vec4 o_drop;
layout(location = 1) out vec4 o_given;  // [mm^3]

void main() {
    o_drop = v_drop.z > 0.0 ? v_drop : vec4(0.0);
    o_given = vec4(max(v_drop.z, 0.0), 0.0, 0.0, 1.0);
}

#version 330 core
flat in vec4 v_drop;
layout(location = 0) out vec4 o_drop;

void main() {
#ifdef LEDGER
    o_drop = vec4(max(v_drop.z, 0.0), 0.0, 0.0, 0.0);
#else
    o_drop = v_drop.z > 0.0 ? v_drop : vec4(0.0);
#endif
}

#version 330 core
// Shows a target in the framebuffer that the host names. One channel shows as grey.
uniform sampler2D u_source;
uniform bool u_grey;
uniform bool u_flip;
in vec2 v_uv;
layout(location = 0) out vec4 o_color;

void main() {
    vec4 texel = texture(u_source, u_flip ? vec2(v_uv.x, 1.0 - v_uv.y) : v_uv);
    o_color = u_grey ? vec4(texel.rrr, 1.0) : texel;
}

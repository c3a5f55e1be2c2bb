#version 330 core
// The pictures of two eyes next to each other, the left one on the left.
uniform sampler2D u_left;
uniform sampler2D u_right;
uniform ivec2 u_has;   // whether left and right hold anything but u_clear
uniform vec4 u_clear;
uniform int u_width;   // of one eye's picture [pixels]
layout(location = 0) out vec4 o_picture;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    bool right = at.x >= u_width;
    ivec2 texel = ivec2(right ? at.x - u_width : at.x, at.y);
    vec4 picture = right ? texelFetch(u_right, texel, 0) : texelFetch(u_left, texel, 0);
    o_picture = (right ? u_has.y : u_has.x) != 0 ? picture : u_clear;
}

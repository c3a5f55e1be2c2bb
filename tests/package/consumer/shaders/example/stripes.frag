#version 330 core
uniform float u_level;
out float stripes;

void main() {
    stripes = (int(gl_FragCoord.x) & 1) == 0 ? u_level : 0.0;
}

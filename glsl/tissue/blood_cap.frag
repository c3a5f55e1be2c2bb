#version 330 core
uniform sampler2D u_position;
uniform float u_aspect;  // height over radius
flat in vec4 v_cap;
layout(location = 0) out float o_height;

void main() {
    vec4 place = texelFetch(u_position, ivec2(gl_FragCoord.xy), 0);
    vec3 away = place.xyz - v_cap.xyz;
    float inside = 1.0 - dot(away, away) / (v_cap.w * v_cap.w);
    o_height = place.w > 0.0 ? u_aspect * v_cap.w * max(inside, 0.0) : 0.0;
}

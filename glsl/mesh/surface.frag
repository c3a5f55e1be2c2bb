#version 330 core
// Blinn-Phong with a light in the eye and LIGHTS more at infinity.
#include "common/unit.glsl"
in vec3 v_place;
in vec3 v_normal;
uniform vec3 u_colour;
uniform float u_ambient;
uniform float u_diffuse;
uniform float u_specular;
uniform float u_shininess;
uniform float u_headlight;
uniform vec3 u_towards_eye;  // orthographic: (0, 0, 1); perspective: 0
#ifdef LIGHTS
uniform vec3 u_light_direction[LIGHTS];  // towards the light, in the eye's frame, unit length
uniform vec3 u_light_colour[LIGHTS];
#endif
layout(location = 0) out vec4 o_colour;

void main() {
    vec3 normal = unit(gl_FrontFacing ? v_normal : -v_normal);
    vec3 eye = unit(u_towards_eye == vec3(0.0) ? -v_place : u_towards_eye);
    float facing = max(dot(normal, eye), 0.0);
    vec3 light = vec3(u_ambient + u_headlight * u_diffuse * facing);
    vec3 shine = vec3(u_headlight * u_specular * pow(facing, u_shininess));
#ifdef LIGHTS
    for (int i = 0; i < LIGHTS; ++i) {
        float lit = max(dot(normal, u_light_direction[i]), 0.0);
        float half_way = max(dot(normal, unit(u_light_direction[i] + eye)), 0.0);
        light += u_light_colour[i] * (u_diffuse * lit);
        shine += u_light_colour[i] * (lit > 0.0 ? u_specular * pow(half_way, u_shininess) : 0.0);
    }
#endif
    o_colour = vec4(u_colour * light + shine, 1.0);
}

// Blinn-Phong under LIGHTS lights, in the eye's axes.
#include "common/unit.glsl"
uniform vec4 u_light_place[LIGHTS];   // as v_place; w 1: a point, 0: the direction towards a light at infinity
uniform vec3 u_light_colour[LIGHTS];
uniform vec2 u_light_fall[LIGHTS];    // 1 / falloff^2 [1/mm^2], exponent of the angle
#ifdef GLOW
uniform vec2 u_light_glow[LIGHTS];    // distance [mm], gain [1/mm^2]
#endif
uniform vec4 u_shading;               // ambient, diffuse, specular with its normalisation, exponent

struct Light {
    vec3 scattered;  // factor on the surface's colour
    vec3 mirrored;   // highlights
    vec3 glow;       // overexposure
};

// max(base, 0)^exponent, with 0^0 = 1, which GLSL leaves undefined.
float power(float base, float exponent) {
    return base > 0.0 ? pow(base, exponent) : float(exponent == 0.0);
}

// eye: unit vector towards the eye; gloss: share of the highlights that is left.
Light light_at(vec3 place, vec3 normal, vec3 eye, float gloss) {
    Light light = Light(vec3(0.0), vec3(0.0), vec3(0.0));
    for (int i = 0; i < LIGHTS; ++i) {
        vec3 way = u_light_place[i].xyz - u_light_place[i].w * place;
        float squared = dot(way, way);
        vec3 towards = unit(way);
        float reach = clamp(1.0 - squared * u_light_fall[i].x, 0.0, 1.0);
        // The view axis points at the viewer, along z.
        reach *= power(towards.z, u_light_fall[i].y);
        vec3 arrives = u_light_colour[i] * (reach * reach);
        float facing = clamp(dot(normal, towards), 0.0, 1.0);
        float half_way = min(dot(normal, unit(towards + eye)), 1.0);
        light.scattered += arrives * (u_shading.x + u_shading.y * facing);
        light.mirrored += arrives * (gloss * u_shading.z * facing * power(half_way, u_shading.w));
#ifdef GLOW
        float gap = max(u_light_glow[i].x - sqrt(squared), 0.0) * u_light_place[i].w;
        light.glow += u_light_colour[i] * min(u_light_glow[i].y * gap * gap, 1.0);
#endif
    }
    return light;
}

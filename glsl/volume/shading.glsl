// Blinn-Phong by the gradient. SHADING: number of lights. LIGHT_AT_EYE: the only one shines from the eye.
// LIGHT_PLACES: some have a place instead of a direction.
uniform vec4 u_lighting;              // ambient, diffuse, specular, shininess
uniform vec4 u_lights[SHADING];       // w 0: towards the light, of length 1; 1: where it is [mm]
uniform vec3 u_light_colours[SHADING];
uniform mat4 u_local_to_world;
uniform float u_outward;              // towards lesser values: -1, where stored numbers fall as values rise: 1

// Of length 1, or 0 where there is no gradient. Scaled by the largest component first: squares would leave the range.
vec3 unit_or_zero(vec3 v) {
    float most = max(max(abs(v.x), abs(v.y)), abs(v.z));
    vec3 n = v / max(most, 1e-30);
    return n * inversesqrt(max(dot(n, n), 1e-6));
}

// How a colour looks in the lights. `view`: from the eye on; `shadow`: share of the first light and of the ambient light
// that arrives.
vec3 shaded(vec3 colour, vec3 gradient, vec3 local, vec3 view, vec2 shadow) {
    vec3 normal = u_outward * unit_or_zero(gradient);
    vec3 result = u_lighting.x * shadow.y * colour;
    for (int i = 0; i < SHADING; ++i) {
#ifdef LIGHT_AT_EYE
        float facing = -dot(normal, view);
        float gloss = facing;
#else
#ifdef LIGHT_PLACES
        vec3 towards = unit_or_zero(u_lights[i].xyz - u_lights[i].w * (u_local_to_world * vec4(local, 1.0)).xyz);
#else
        vec3 towards = u_lights[i].xyz;
#endif
        float facing = dot(normal, towards);
        float gloss = dot(normal, unit_or_zero(towards - view));
#endif
#ifdef TWO_SIDED
        facing = abs(facing);
        gloss = abs(gloss);
#endif
        float arrives = i == 0 ? shadow.x : 1.0;
        float highlight = facing > 0.0 ? u_lighting.z * pow(max(gloss, 1e-6), u_lighting.w) : 0.0;
        result += arrives * u_light_colours[i] * (u_lighting.y * max(facing, 0.0) * colour + highlight);
    }
    return result;
}

#version 330 core
// The vessel surface. Density is decided per fragment, so that the front is smooth whatever the mesh.
in vec3 a_position;  // [mm]
#ifdef MAIN
in float a_scalar;  // ARRIVAL: arrival time [s]; otherwise density
#ifdef ARRIVAL
uniform float u_time_since_start;  // [s]
#endif
out float v_scalar;
#if defined(CALIBRE) || defined(THICKNESS)
in vec2 a_uv;  // x: share of the density that shows in a vessel of this calibre, y: the axis's x
#endif
#ifdef CALIBRE
out float v_weight;
#endif
#ifdef THICKNESS
in vec3 a_normal;      // from the vessel's axis to this vertex [mm]
in vec2 a_picture_uv;  // the axis's y and z: its direction, shorter at rounded ends
uniform vec4 u_eye;    // xyz: the eye [mm] and w = 1; or against the parallel rays and w = 0
out float v_half_way;  // of the ray, from the axis to this wall [mm], negative in front of the axis

// A ray that crosses the axis at a slant goes 1 / sin of it as far as in the cross-section. Along the axis that grows without bound, but
// vessels bend.
float half_way() {
    const float least_slant = 0.3;
    vec3 sight = normalize(u_eye.w * a_position - u_eye.xyz);
    vec3 axis = vec3(a_uv.y, a_picture_uv);
    vec3 across = sight - dot(sight, axis) * axis;
    float slant = length(across);
    return dot(a_normal, across) / (max(slant, 1e-4) * max(slant, least_slant));
}
#endif
#endif
#ifdef INJECTION
uniform vec3 u_injection_point;  // [mm]
out vec3 v_from_injection;
#endif
uniform mat4 u_view_projection;

void main() {
#ifdef CALIBRE
    v_weight = a_uv.x;
#endif
#ifdef MAIN
#ifdef THICKNESS
    v_half_way = half_way();
#endif
#ifdef ARRIVAL
    // The difference is formed here: near the front it is small, and so is the rounding of its interpolation.
    v_scalar = u_time_since_start - a_scalar;
#else
    v_scalar = a_scalar;
#endif
#endif
#ifdef INJECTION
    v_from_injection = a_position - u_injection_point;
#endif
    gl_Position = u_view_projection * vec4(a_position, 1.0);
}

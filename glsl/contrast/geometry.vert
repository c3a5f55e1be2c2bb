#version 330 core
// The vessel surface. Density is decided per fragment, so that the front is smooth whatever the mesh.
in vec3 a_position;  // [mm]
#ifdef MAIN
in float a_scalar;  // ARRIVAL: arrival time [s]; otherwise density
#ifdef ARRIVAL
uniform float u_time_since_start;  // [s]
#endif
out float v_scalar;
#ifdef CALIBRE
in vec2 a_uv;  // x: share of the density that shows in a vessel of this calibre
out float v_weight;
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

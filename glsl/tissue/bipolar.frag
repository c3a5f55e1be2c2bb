#version 330 core
#include "common/texel.glsl"
// Tissue between the jaws of a bipolar tool. CAPSULE, BOX, SPHERE or CYLINDER: the tool's shape, about the
// origin of its frame, with its axis along x.
#include "tissue/list.glsl"
uniform sampler2D u_before;
uniform sampler2D u_position;
uniform sampler2D u_triangles;  // by texel: 1 + its triangle, 0 none
uniform sampler2D u_held;       // by triangle: 1 held; four to an item
uniform mat4 u_to_tool;
uniform vec3 u_size_mm;
uniform float u_energy;
uniform float u_size;  // texels along each side
layout(location = 0) out float o_energy;

bool inside(vec3 p) {
#if defined(BOX)
    return all(lessThan(abs(p), 0.5 * u_size_mm));
#elif defined(SPHERE)
    return dot(p, p) < u_size_mm.z * u_size_mm.z;
#elif defined(CYLINDER)
    return abs(p.x) < 0.5 * u_size_mm.x && dot(p.yz, p.yz) < u_size_mm.z * u_size_mm.z;
#else
    vec3 off = vec3(max(abs(p.x) - 0.5 * u_size_mm.x, 0.0), p.yz);
    return dot(off, off) < u_size_mm.z * u_size_mm.z;
#endif
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    // Nothing burnt yet is a single black texel, so it is looked up by coordinates.
    float e = textureLod(u_before, gl_FragCoord.xy / u_size, 0.0).r;
    int triangle = int(texel_at(u_triangles, texel).r) - 1;
    bool held = triangle >= 0 && list_item(u_held, max(triangle, 0) >> 2)[max(triangle, 0) & 3] > 0.5;
    vec3 place = (u_to_tool * vec4(texel_at(u_position, texel).xyz, 1.0)).xyz;
    o_energy = held && inside(place) ? max(e, u_energy) : e;
}

#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_place.glsl"
#include "tissue/blood_drop.glsl"
// New drops, each a point at its place in the ring.
#include "tissue/drop_ring.glsl"
uniform sampler2D u_spawn;  // two items for each: u, v, volume [mm^3], radius of the source [mm]; place in the ring, seed, UV that decides
uniform sampler2D u_metric;
#ifdef ENERGY
uniform sampler2D u_energy;
uniform float u_sealed;  // energy at which tissue no longer bleeds
#endif
uniform vec2 u_ring;  // size of the ring's texture
flat out vec4 v_drop;

void main() {
    vec4 source = list_item(u_spawn, 2 * gl_VertexID);
    vec4 more = list_item(u_spawn, 2 * gl_VertexID + 1);
    vec2 size = vec2(textureSize(u_film, 0));
    vec2 centre = source.xy * size;
    uint seed = uint(more.y);
    float r = source.w * sqrt(drop_noise(seed, 1u));
    float angle = 6.2831853 * drop_noise(seed, 2u);
    vec4 metric = texel_at(u_metric, clamp(ivec2(floor(centre)), ivec2(0), ivec2(size) - 1));
    vec2 offset = clamp(texels_of(r * vec2(cos(angle), sin(angle)), metric), vec2(-12.0), vec2(12.0));
    vec3 at = place_on_surface(centre + offset);
    if (at.z == 0.0) {
        at = place_on_surface(centre);
    }
    float volume = at.z > 0.0 ? source.z : 0.0;
#ifdef ENERGY
    // What flew was given where it left, not where it came down.
    vec2 decides = more.z >= 0.0 ? more.zw : at.xy / size;
    float energy = texel_at(u_energy, ivec2(clamp(decides, 0.0, 0.9999) * vec2(textureSize(u_energy, 0)))).r;
    volume *= 1.0 - smoothstep(0.5 * u_sealed, u_sealed, energy);
#endif
    v_drop = vec4(at.xy / size, volume, 0.0);
    gl_Position = vec4(2.0 * (vec2(drop_texel(int(more.x))) + 0.5) / u_ring - 1.0, 0.0, 1.0);
}

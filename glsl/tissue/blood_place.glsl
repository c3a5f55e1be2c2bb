#include "common/texel.glsl"
#include "tissue/list.glsl"
// Where a point of texture space lies on the surface, once it has left its chart.
uniform sampler2D u_film;     // w > 0: surface; -1: gutter
uniform sampler2D u_numbers;  // of gutters in the lists
uniform sampler2D u_jumps;    // lists of blood_jump.frag
uniform sampler2D u_slopes;

/// A point, in texels; z: 0 there is no surface, 1 as it was, 2 taken across a seam.
vec3 place_on_surface(vec2 texel) {
    ivec2 last = textureSize(u_film, 0) - 1;
    ivec2 at = ivec2(floor(texel));
    if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
        return vec3(texel, 0.0);
    }
    float kind = texel_at(u_film, at).w;
    if (kind >= 0.0) {
        return vec3(texel, kind > 0.0 ? 1.0 : 0.0);
    }
    int number = max(int(texel_at(u_numbers, at).r), 0);
    vec4 jump = list_item(u_jumps, number);
    vec4 slopes = list_item(u_slopes, number);
    vec2 offset = texel - (vec2(at) + 0.5);
    vec2 to = jump.xy + offset.x * slopes.xy + offset.y * slopes.zw;
    ivec2 there = ivec2(floor(to));
    // Past the texture's border lies what lies at it.
    bool found = there == clamp(there, ivec2(0), last) && texel_at(u_film, there).w > 0.0;
    return vec3(found ? to : jump.zw, found || jump.z >= 0.0 ? 2.0 : 0.0);
}

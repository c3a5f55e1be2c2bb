#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_common.glsl"
#include "tissue/blood_place.glsl"
#include "tissue/blood_plan.glsl"
#include "tissue/blood_drop.glsl"
// One step of every drop: it runs down the surface, leaves a film behind, and gives itself up to the film where it comes to rest, meets
// a film as deep as itself, or has grown old.
uniform sampler2D u_drops;
uniform sampler2D u_gravity;
uniform float u_strength;  // of gravity, in units of standard gravity
uniform bool u_open;
#ifdef TOOLS
#include "tissue/blood_tools.glsl"
#endif
layout(location = 0) out vec4 o_drop;
layout(location = 1) out vec4 o_deposit;  // volume that becomes film, volume that is gone [mm^3], radius of the drop [mm]

const float longest_step = 2.0;  // [texels]
const float giving_up_s = 0.05;
const float longest_end_s = 1.0;  // from its life's end until nothing is left of a drop
const float slowest = 0.02;      // [mm/s]

vec4 gravity_at(vec2 texel) {
    return texel_at(u_gravity, ivec2(floor(texel)));
}

void main() {
    vec4 drop = texel_at(u_drops, ivec2(gl_FragCoord.xy));
    o_drop = vec4(0.0);
    o_deposit = vec4(0.0);
    if (!(drop.z > 0.0)) {
        return;
    }
    float dt = u_flow.z;
    vec2 size = vec2(textureSize(u_film, 0));
    vec2 from = drop.xy * size;
    float radius = drop_radius(drop.z);
    float height = u_drop.x * radius;
    float fastest = u_flow.x * (1.0 / 3.0) * height * height * u_strength;

    vec4 g0 = gravity_at(from);
    vec2 v0 = g0.xy * (g0.z * g0.w) * fastest * size;  // [texels/s]
    float cap = min(1.0, longest_step / max(length(v0) * dt, 1e-20));
    vec3 middle = place_on_surface(from + (0.5 * dt * cap) * v0);
    vec4 g1 = middle.z > 0.0 ? gravity_at(middle.xy) : g0;
    vec2 v1 = g1.xy * (g1.z * g1.w) * fastest * size;
    cap = min(1.0, longest_step / max(length(v1) * dt, 1e-20));
    // A direction holds in the chart in which it was read.
    vec3 to = middle.z == 2.0 ? place_on_surface(middle.xy + (0.5 * dt * cap) * v1) : place_on_surface(from + (dt * cap) * v1);
    // Where the surface has collapsed under it, it stays and waits until its life ends.
    vec4 below = texel_at(u_film, ivec2(floor(from)));
    bool waits = below.w == 0.0;
    to = waits ? vec3(from, 1.0) : to;
    bool falls = to.z == 0.0;
    // Past the corner of a chart a drop may come to where no plan has looked: there it waits for the next one.
    if (!falls && !steps_at(ivec2(floor(to.xy)))) {
        o_drop = drop;
        return;
    }
    float speed = fastest * g1.z * cap;  // [mm/s]

    float volume = drop.z;
    float deposit = u_drop.y * 2.0 * radius * speed * dt;
    bool stands = speed < slowest || below.x > 0.8 * height;
    bool rests = (stands && !waits) || drop.w > u_drop.z || (falls && !u_open);
    if (rests) {
        deposit = max(deposit, volume * (1.0 - exp(-dt / giving_up_s)));
    }
    float left = max(volume - deposit, 0.0);
    float gone = 0.0;
    if (falls && u_open) {
        gone = volume;
        left = 0.0;
    }
#ifdef TOOLS
    // The same share as of a film as high; what is too little to go on as a drop goes with it.
    float share = waits ? 0.0 : taken(ivec2(floor(from)), height) / height;
    float rest = left;
    left *= 1.0 - share;
    left = left < u_drop.w ? 0.0 : left;
    gone += share > 0.0 ? rest - left : 0.0;
#endif
    left = left < u_drop.w || drop.w > u_drop.z + longest_end_s ? 0.0 : left;
    // What becomes film is found from what the drop keeps, so that nothing is lost in rounding.
    o_deposit = vec4(max(volume - left - gone, 0.0), gone, radius, 0.0);
    o_drop = left > 0.0 ? vec4((to.z > 0.0 ? to.xy : from) / size, left, drop.w + dt) : vec4(0.0);
}

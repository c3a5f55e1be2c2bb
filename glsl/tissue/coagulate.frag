#version 330 core
// Energy that contacts give in one frame. METRIC_UV: distances in the texture in place of the world.
// LONG_WAYS: see contact.glsl. IN_STEPS: contacts come in several steps, which act one after the other.
#include "tissue/list.glsl"
#include "tissue/contact.glsl"
#include "tissue/energy_rules.glsl"
uniform sampler2D u_last;
uniform sampler2D u_contacts;  // see add_contact()
uniform sampler2D u_list;      // numbers of contacts, four to an item
uniform float u_size;          // texels along each side of the target
uniform float u_keep;          // 0: begin with nothing
uniform float u_e_max;
uniform bool u_half;           // the target holds half floats
uniform vec4 u_limit;          // a place, and the square of the distance from it outside which nothing changes
#ifndef METRIC_UV
uniform sampler2D u_position;
#endif
flat in ivec2 v_contacts;
layout(location = 0) out float o_energy;

// What a half float holds, with room to spare.
const float largest_energy = 60000.0;

float with_dose(float e, vec3 sums, vec3 largest) {
    vec3 dose = min(sums, largest);
    e = coagulated(e, dose.x);
    e = sounded(e, dose.y, u_e_max);
    return dissected(e, dose.z, u_e_max);
}

// Software renderers cut the digits off that a half float has no room for. A state would creep towards 0 with
// each increment that is too small for it, so it is rounded to nearest here.
float storable(float e) {
    uint bits = floatBitsToUint(e);
    uint nearest = (bits + 0x0fffu + ((bits >> 13) & 1u)) & ~0x1fffu;
    return u_half ? uintBitsToFloat(nearest) : e;
}

void main() {
    // The last content may be a single black texel, so it is looked up by coordinates.
    vec2 uv = gl_FragCoord.xy / u_size;
    float e = u_keep * textureLod(u_last, uv, 0.0).r;
#ifdef METRIC_UV
    vec3 place = vec3(uv, 0.0);
    bool there = true;
#else
    vec4 position = texelFetch(u_position, ivec2(gl_FragCoord.xy), 0);
    vec3 place = position.xyz;
    bool there = position.w > 0.0;
#endif
    vec3 from_limit = place - u_limit.xyz;
    bool within = there && dot(from_limit, from_limit) <= u_limit.w;
    float changed = e;
    vec3 sums = vec3(0.0);
    vec3 largest = vec3(0.0);
    float last_step = 0.0;
    for (int i = 0; i < v_contacts.y; ++i) {
        int entry = v_contacts.x + i;
        int number = 3 * int(list_item(u_list, entry >> 2)[entry & 3]);
        vec4 kind = list_item(u_contacts, number + 2);
#ifdef IN_STEPS
        if (kind.w != last_step) {
            changed = with_dose(changed, sums, largest);
            sums = vec3(0.0);
            largest = vec3(0.0);
            last_step = kind.w;
        }
#endif
        add_contact(list_item(u_contacts, number), list_item(u_contacts, number + 1), kind, place, sums, largest);
    }
    e = within ? with_dose(changed, sums, largest) : e;
    o_energy = storable(clamp(e, -largest_energy, largest_energy));
}

#version 330 core
#include "common/texel.glsl"
// Energy that contacts give in one frame. METRIC_UV: distances in the texture in place of the world.
// LONG_WAYS: see contact.glsl. IN_STEPS: contacts come in several steps, which act one after the other.
#include "tissue/list.glsl"
#include "tissue/contact.glsl"
#include "tissue/energy_rules.glsl"
#include "tissue/energy_store.glsl"
uniform sampler2D u_contacts;  // see add_contact()
uniform sampler2D u_list;      // numbers of contacts, four to an item
uniform float u_e_max;
uniform vec4 u_limit;          // a place, and the square of the distance from it outside which nothing changes
#ifndef METRIC_UV
uniform sampler2D u_position;
#endif
flat in ivec2 v_contacts;
layout(location = 0) out float o_energy;

float with_dose(float e, vec3 sums, vec3 largest) {
    vec3 dose = min(sums, largest);
    e = coagulated(e, dose.x);
    e = sounded(e, dose.y, u_e_max);
    return dissected(e, dose.z, u_e_max);
}

void main() {
    float e = last_energy();
#ifdef METRIC_UV
    vec3 place = vec3(gl_FragCoord.xy / u_size, 0.0);
    bool there = true;
#else
    vec4 position = texel_at(u_position, ivec2(gl_FragCoord.xy));
    vec3 place = position.xyz;
    bool there = position.w > 0.0;
#endif
    vec3 from_limit = place - u_limit.xyz;
    bool within = there && dot(from_limit, from_limit) <= u_limit.w;
    float changed = e;
    vec3 sums = vec3(0.0);
    vec3 largest = vec3(0.0);
    float last_step = 0.0;
    int entry = v_contacts.x;
    int end = entry + v_contacts.y;
    // The condition last: software renderers run a body once more to find one at its beginning false. Each square has a contact.
    do {
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
    } while (++entry < end);
    e = within ? with_dose(changed, sums, largest) : e;
    o_energy = storable(e);
}

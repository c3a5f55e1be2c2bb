#version 330 core
#include "common/texel.glsl"
#include "tissue/blood_place.glsl"
#include "tissue/blood_plan.glsl"
#include "tissue/blood_drop.glsl"
#include "tissue/drop_ring.glsl"
// Lays what drops leave behind onto the film: four points for each drop within its outline, another four in each step, so that in time
// all of the outline is covered alike. A point changes one texel by the volume over that texel's area: no volume is lost, whatever the
// map does to lengths.
uniform sampler2D u_drops;    // before the step
#ifndef WHOLE
uniform sampler2D u_deposit;  // of blood_move.frag; with WHOLE the drops go into the film as they are
#endif
uniform sampler2D u_metric;
uniform int u_salt;  // of the step
flat out vec2 v_added;

const int points = 4;

void main() {
    int index = drop_place(gl_VertexID / points);
    int k = gl_VertexID % points;
    ivec2 place = drop_texel(index);
    vec4 drop = texel_at(u_drops, place);
    vec2 size = vec2(textureSize(u_film, 0));
#ifdef WHOLE
    vec2 lost = vec2(max(drop.z, 0.0), 0.0);
    float radius = drop_radius(lost.x);
#else
    vec4 deposit = texel_at(u_deposit, place);
    vec2 lost = deposit.xy;
    float radius = deposit.z;
#endif
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    v_added = vec2(0.0);
    if (lost.x + lost.y > 0.0) {
        vec2 at = drop.xy * size;
        float area = texel_at(u_film, ivec2(floor(at))).w;
        // What lies on a cell that has collapsed stays there, and so does what is only counted.
        if (lost.x > 0.0 && area > 0.0) {
            vec4 metric = texel_at(u_metric, ivec2(floor(at)));
            float r = radius * sqrt((float(k) + drop_noise(uint(index), uint(u_salt))) / float(points));
            float angle = 6.2831853 * (drop_noise(uint(index), uint(u_salt) + 77777u) + 0.38196601 * float(k));
            vec2 offset = clamp(texels_of(r * vec2(cos(angle), sin(angle)), metric), vec2(-12.0), vec2(12.0));
            vec3 to = place_on_surface(at + offset);
            at = to.z > 0.0 && steps_at(ivec2(floor(to.xy))) ? to.xy : at;
        }
        ivec2 texel = ivec2(floor(at));
        area = texel_at(u_film, texel).w;
        v_added = 0.25 * lost / (area > 0.0 ? area : 1.0);
        gl_Position = vec4(2.0 * (vec2(texel) + 0.5) / size - 1.0, 0.0, 1.0);
    }
}

#version 330 core
#include "tissue/blood_common.glsl"
#include "tissue/blood_plan.glsl"
#include "tissue/blood_part.glsl"
#include "tissue/list.glsl"
// What comes across seams in a step, for each cell that lies at one.
uniform sampler2D u_film;
uniform sampler2D u_cells;  // at seams: x, y, where its parts begin in u_pulls, 1; in chunks of 4 x 4, each of one block
uniform sampler2D u_pulls;  // of blood_link.frag
layout(location = 0) out float o_came;  // [mm]

void main() {
    vec4 item = texelFetch(u_cells, ivec2(gl_FragCoord.xy), 0);
    ivec2 here = ivec2(item.xy);
    vec4 film = texelFetch(u_film, here, 0);
    int part = int(item.z);
    float came = 0.0;  // [mm^3]
    bool more = item.w > 0.0 && film.w > 0.0;
    while (more) {
        vec4 pull = list_item(u_pulls, part);
        ivec2 cell = cell_of_part(pull);
        float there = texelFetch(u_film, cell, 0).x;
        // From a block that rests nothing comes: it would not leave there.
        bool flows = pull.z > 0.0 && steps_at(cell);
        came -= flows ? exchange(pull.y - pull.x * (there - film.x), pull.x, pull.z, film.x, there) : 0.0;
        more = pull.w > 0.0;
        ++part;
    }
    o_came = film.w > 0.0 ? came / film.w : 0.0;
}

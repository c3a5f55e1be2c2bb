#version 330 core
#include "tissue/blood_common.glsl"
// What flows through the parts of seams in a step: two points for each part, one takes and one gives the same volume.
uniform sampler2D u_film;   // before the step
uniform sampler2D u_links;  // cell, cell across
uniform sampler2D u_pulls;  // of blood_link.frag
flat out vec2 v_added;

void main() {
    ivec2 links = textureSize(u_links, 0);
    int index = gl_VertexID / 2;
    ivec2 at = ivec2(index % links.x, index / links.x);
    vec4 link = texelFetch(u_links, at, 0);
    vec4 pull = texelFetch(u_pulls, at, 0);
    ivec2 size = textureSize(u_film, 0);
    ivec2 from = ivec2(int(link.x) % size.x, int(link.x) / size.x);
    ivec2 to = ivec2(int(link.y) % size.x, int(link.y) / size.x);
    vec4 a = texelFetch(u_film, from, 0);
    vec4 b = texelFetch(u_film, to, 0);
    float volume = pull.z > 0.0 ? exchange(pull.y - pull.x * (b.x - a.x), pull.x, pull.z, a.x, b.x) : 0.0;
    bool gives = (gl_VertexID & 1) == 0;
    ivec2 texel = gives ? from : to;
    v_added = vec2(gives ? -volume / a.w : volume / b.w, 0.0);
    gl_Position = volume != 0.0 ? vec4(2.0 * (vec2(texel) + 0.5) / vec2(size) - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}

#version 330 core
// One square of texels per instance, with the contacts that reach it.
#include "tissue/list.glsl"
uniform sampler2D u_tiles;  // x + 1024 y [tiles]; its contacts in the list: the first one is 4096 y + z, w of them
uniform int u_first_tile;
uniform float u_tile_texels;
uniform float u_size;  // texels along each side of the target
flat out ivec2 v_contacts;

void main() {
    vec4 tile = list_item(u_tiles, u_first_tile + gl_InstanceID);
    ivec4 part = ivec4(tile);
    v_contacts = ivec2((part.y << 12) + part.z, part.w);
    vec2 place = vec2(float(part.x & 1023), float(part.x >> 10));
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
    gl_Position = vec4(2.0 * (place + corner) * u_tile_texels / u_size - 1.0, 0.0, 1.0);
}

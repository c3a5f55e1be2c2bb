#version 330 core
#include "tissue/list.glsl"
// Marks by points the tiles across seams from marked ones and their neighbours.
uniform sampler2D u_pairs;  // one side, other side: x, y each, of tiles that a seam joins
uniform sampler2D u_tiles;  // of blood_scan.frag
flat out float v_mark;

void main() {
    vec4 pair = list_item(u_pairs, gl_VertexID);
    ivec2 size = textureSize(u_tiles, 0);
    float most = 0.0;
    for (int i = 0; i < 9; ++i) {
        most = max(most, texelFetch(u_tiles, clamp(ivec2(pair.xy) + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), size - 1), 0).r);
    }
    v_mark = 1.0;
    gl_PointSize = 1.0;
    gl_Position = most > 0.5 ? vec4(2.0 * (pair.zw + 0.5) / vec2(size) - 1.0, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}

// Bruises: the nearest spot in terms of its radius decides. HEMATOMA 1: distances in the world; 2: in texture space. Each pixel looks
// at the spots of its cell alone: of the picture (1) or of texture space (2).
uniform sampler2D u_spots;        // centre, 1 / radius; rows of 1024
uniform sampler2D u_spot_cells;   // first spot of the cell, how many
uniform vec2 u_cells_per_unit;    // of gl_FragCoord (1), of UV (2)
uniform vec4 u_hematoma;          // colour, share of it in the middle

// place: as the spots' centres; at: where to look for the cell.
vec3 bruised(vec3 colour, vec3 place, vec2 at) {
    vec2 last = vec2(textureSize(u_spot_cells, 0) - 1);
    ivec2 spots = ivec2(texelFetch(u_spot_cells, ivec2(clamp(floor(at * u_cells_per_unit), vec2(0.0), last)), 0).xy);
    float most = 0.0;
    for (int i = spots.x; i < spots.x + spots.y; ++i) {
        vec4 spot = texelFetch(u_spots, ivec2(i & 1023, i >> 10), 0);
        most = max(most, 1.0 - distance(place, spot.xyz) * spot.w);
    }
    return mix(colour, u_hematoma.rgb, u_hematoma.a * most);
}

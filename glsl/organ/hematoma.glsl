// Bruises: the nearest spot in terms of its radius decides. HEMATOMA 1: distances in the world; 2: in texture space.
uniform sampler2D u_spots;      // centre, 1 / radius; rows of u_spot_columns
uniform int u_spot_count;
uniform int u_spot_columns;
uniform vec4 u_hematoma;        // colour, share of it in the middle

vec3 bruised(vec3 colour, vec3 place) {
    float most = 0.0;
    for (int i = 0; i < u_spot_count; ++i) {
        vec4 spot = texelFetch(u_spots, ivec2(i % u_spot_columns, i / u_spot_columns), 0);
        most = max(most, 1.0 - distance(place, spot.xyz) * spot.w);
    }
    return mix(colour, u_hematoma.rgb, u_hematoma.a * most);
}

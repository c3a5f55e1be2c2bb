// Trilinear reconstruction with weights of full precision: eight voxels.

// Value and derivative along x, y and z per voxel.
vec4 linear_jet(vec3 place) {
    Cell cell = cell_at(place);
    vec3 a = cell.a;
    ivec3 low = inside_volume(ivec3(cell.low));
    ivec3 high = inside_volume(ivec3(cell.low) + 1);
    // Along x for (y, z) = (low, low), (high, low), (low, high), (high, high).
    vec4 start = vec4(texel(low), texel(ivec3(low.x, high.y, low.z)), texel(ivec3(low.xy, high.z)),
                      texel(ivec3(low.x, high.yz)));
    vec4 end = vec4(texel(ivec3(high.x, low.yz)), texel(ivec3(high.xy, low.z)),
                    texel(ivec3(high.x, low.y, high.z)), texel(high));
    vec4 step_x = end - start;
    vec4 row = start + a.x * step_x;
    vec2 step_y = row.yw - row.xz;
    vec2 plane = row.xz + a.y * step_y;
    vec2 slope_x = step_x.xz + a.y * (step_x.yw - step_x.xz);
    return vec4(plane.x + a.z * (plane.y - plane.x), slope_x.x + a.z * (slope_x.y - slope_x.x),
                step_y.x + a.z * (step_y.y - step_y.x), plane.y - plane.x);
}

#ifdef COLOURS
vec4 sample_colour(vec3 place) {
    Cell cell = cell_at(place);
    ivec3 low = inside_volume(ivec3(cell.low));
    ivec3 high = inside_volume(ivec3(cell.low) + 1);
    vec4 a = mix(voxel_at(low), voxel_at(ivec3(high.x, low.yz)), cell.a.x);
    vec4 b = mix(voxel_at(ivec3(low.x, high.y, low.z)), voxel_at(ivec3(high.xy, low.z)), cell.a.x);
    vec4 c = mix(voxel_at(ivec3(low.xy, high.z)), voxel_at(ivec3(high.x, low.y, high.z)), cell.a.x);
    vec4 d = mix(voxel_at(ivec3(low.x, high.yz)), voxel_at(high), cell.a.x);
    return mix(mix(a, b, cell.a.y), mix(c, d, cell.a.y), cell.a.z);
}
#else
float sample_volume(vec3 place) {
    return linear_jet(place).x;
}
#endif

vec3 filter_gradient(vec3 place) {
    return linear_jet(place).yzw * vec3(volume_size());
}

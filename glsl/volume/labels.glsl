// Segments: each voxel of a second grid names one. Never filtered.
#ifdef STORAGE_ATLAS
uniform usampler2DArray u_labels;
uniform ivec3 u_labels_size;   // voxels
uniform ivec2 u_labels_tiles;  // as u_atlas_tiles
#else
uniform usampler3D u_labels;
#endif
uniform mat4 u_labels_from_local;   // local -> voxels of the label grid
#ifdef COORDINATES
uniform bool u_labels_curved;       // the label grid has the volume's shape: texture coordinates -> voxels instead
uniform vec3 u_labels_scale;
uniform vec3 u_labels_offset;
#endif
uniform sampler2D u_label_looks;    // row 0: colour, its weight; row 1: factor on extinction, row of the ramp
#ifdef LABEL_RAMPS
uniform sampler2D u_label_ramps;    // as u_transfer, one row for each ramp; row 0 is the transfer function
#endif

ivec3 label_voxels() {
#ifdef STORAGE_ATLAS
    return u_labels_size;
#else
    return textureSize(u_labels, 0);
#endif
}

int label_of(ivec3 voxel) {
#ifdef STORAGE_ATLAS
    ivec3 tile = atlas_tile(u_labels_size, u_labels_tiles, voxel.z);
    return int(texelFetch(u_labels, ivec3(tile.xy + voxel.xy, tile.z), 0).r);
#else
    return int(texelFetch(u_labels, voxel, 0).r);
#endif
}

// Index of the segment's look; 0: the default, also outside of the label grid.
int label_at(vec3 local) {
    vec3 place = (u_labels_from_local * vec4(local, 1.0)).xyz;
#ifdef COORDINATES
    place = u_labels_curved ? to_sample(local) * u_labels_scale + u_labels_offset : place;
#endif
    ivec3 voxel = ivec3(floor(place));
    ivec3 size = label_voxels();
#ifdef COORDINATES
    voxel.ANGLE = u_labels_curved ? on_ring(voxel.ANGLE, size.ANGLE) : voxel.ANGLE;
    place.ANGLE = u_labels_curved ? float(voxel.ANGLE) : place.ANGLE;
#endif
    // Rays begin and end on faces, and rounding decides on which side.
    const float rounding = 1e-3;
    bool inside = all(greaterThan(place, vec3(-rounding))) && all(lessThan(place, vec3(size) + rounding));
    int found = label_of(clamp(voxel, ivec3(0), size - 1));
    return inside ? found : 0;
}

// Factor on the extinction in a segment; 0: hidden.
float factor_of(int label) {
    return texelFetch(u_label_looks, ivec2(label, 1), 0).x;
}

// Colour and extinction in a segment.
vec4 labelled(vec4 c, int label) {
    vec4 look = texelFetch(u_label_looks, ivec2(label, 0), 0);
    return vec4(mix(c.rgb, look.rgb, look.a), c.a * factor_of(label));
}

// Row of the segment's transfer function.
int ramp_of(int label) {
#ifdef LABEL_RAMPS
    return int(texelFetch(u_label_looks, ivec2(label, 1), 0).y);
#else
    return 0;
#endif
}

// By the segment's transfer function, neither tinted nor thinned.
vec4 classify_segment(float value, int label) {
#ifdef LABEL_RAMPS
    int row = ramp_of(label);
    float place = clamp(value * u_transfer_place.x + u_transfer_place.y, 0.0, u_transfer_place.z);
#ifdef TRANSFER_LINEAR
    int entry = int(place);
    vec4 c = mix(texelFetch(u_label_ramps, ivec2(entry, row), 0),
                 texelFetch(u_label_ramps, ivec2(min(entry + 1, int(u_transfer_place.z)), row), 0), place - float(entry));
#else
    vec4 c = texelFetch(u_label_ramps, ivec2(int(place + 0.5), row), 0);
#endif
    return c;
#else
    return classify(value);
#endif
}

vec4 classify_label(float value, int label) {
    return labelled(classify_segment(value, label), label);
}

// A second, coarser volume gives the hue; the brightness stays.
#ifdef STORAGE_ATLAS
uniform sampler2DArray u_overlay;
uniform ivec3 u_overlay_size;   // voxels
uniform ivec2 u_overlay_tiles;  // as u_atlas_tiles
#else
uniform sampler3D u_overlay;
#endif
uniform mat4 u_overlay_from_local;  // local -> texture coordinates of the overlay
#ifdef COORDINATES
uniform bool u_overlay_curved;      // the overlay has the volume's shape: texture coordinates -> its own instead
uniform vec3 u_overlay_scale;
uniform vec3 u_overlay_offset;
#endif
uniform vec2 u_overlay_place;       // texel -> place in the colour map: x * texel + y
uniform float u_overlay_strength;
uniform sampler2D u_overlay_map;    // colour and share of the strength, one row

ivec3 overlay_voxels() {
#ifdef STORAGE_ATLAS
    return u_overlay_size;
#else
    return textureSize(u_overlay, 0);
#endif
}

float overlay_value(vec3 place, bool ring) {
#ifdef STORAGE_ATLAS
    return linear_in_atlas(u_overlay, u_overlay_size, u_overlay_tiles, place, ring).r;
#else
    return textureLod(u_overlay, place, 0.0).r;
#endif
}

// Fusion in the HSV model: hue and saturation of the map, value of the colour.
vec3 overlaid(vec3 colour, vec3 local) {
    vec3 place = (u_overlay_from_local * vec4(local, 1.0)).xyz;
#ifdef COORDINATES
    // Both end at the same places; across the seam of a ring the overlay's sampler repeats.
    place = u_overlay_curved ? to_sample(local) * u_overlay_scale + u_overlay_offset : place;
    vec3 edge = 0.5 / vec3(overlay_voxels());
    vec3 between = clamp(place, edge, 1.0 - edge);
    bool ring = u_overlay_curved && u_ring;
    between.ANGLE = ring ? place.ANGLE : between.ANGLE;
    place = u_overlay_curved ? between : place;
#else
    const bool ring = false;
#endif
    float share = overlay_value(place, ring) * u_overlay_place.x + u_overlay_place.y;
    bool inside = all(greaterThanEqual(place, vec3(0.0))) && all(lessThanEqual(place, vec3(1.0)));
#ifdef COORDINATES
    inside = inside || u_overlay_curved;
#endif
    float last = float(textureSize(u_overlay_map, 0).x - 1);
    vec4 hue = texelFetch(u_overlay_map, ivec2(int(clamp(share, 0.0, 1.0) * last + 0.5), 0), 0);
    float brightness = max(max(colour.r, colour.g), colour.b);
    // The colour of the map's hue and saturation whose largest component is the brightness.
    vec3 fused = hue.rgb * (brightness / max(max(max(hue.r, hue.g), hue.b), 1e-6));
    return mix(colour, fused, inside ? u_overlay_strength * hue.a : 0.0);
}

// Where voxels are read: a 3-D texture, or slices tiled over the layers of an array (STORAGE_ATLAS), for what exceeds
// the limit of 3-D textures: effects/volume/atlas.h. A voxel is a number, or a colour (COLOURS), of which derivatives
// take the opacity.
#ifdef COLOURS
#define VOXEL vec4
#define CHANNELS rgba
#define NUMBER(voxel) (voxel).a
#define SAMPLE sample_colour  // what a filter is called
#else
#define VOXEL float
#define CHANNELS r
#define NUMBER(voxel) (voxel)
#define SAMPLE sample_volume
#endif
#ifdef COORDINATES
// Curvilinear: first and last voxel along the angle may be neighbours.
uniform bool u_ring;
#if COORDINATES == 1
#define ANGLE y
#else
#define ANGLE x
#endif

// A voxel of the line along the angle, counted on beyond the ends.
int on_ring(int voxel, int count) {
    int turns = int(floor((float(voxel) + 0.5) / float(count)));
    return u_ring ? voxel - turns * count : clamp(voxel, 0, count - 1);
}

ivec4 on_ring(ivec4 voxels, int count) {
    ivec4 turns = ivec4(floor((vec4(voxels) + 0.5) / float(count)));
    return u_ring ? voxels - turns * count : clamp(voxels, ivec4(0), ivec4(count - 1));
}
#endif

#include "volume/atlas.glsl"
#ifdef STORAGE_ATLAS
uniform sampler2DArray u_volume;
uniform ivec3 u_volume_size;  // voxels
uniform ivec2 u_atlas_tiles;  // slices beside and above each other on a layer

ivec3 volume_size() {
    return u_volume_size;
}

VOXEL voxel_at(ivec3 voxel) {
    ivec3 tile = atlas_tile(u_volume_size, u_atlas_tiles, voxel.z);
    return texelFetch(u_volume, ivec3(tile.xy + voxel.xy, tile.z), 0).CHANNELS;
}

VOXEL linear_voxel(vec3 place) {
#ifdef COORDINATES
    return linear_in_atlas(u_volume, u_volume_size, u_atlas_tiles, place, u_ring).CHANNELS;
#else
    return linear_in_atlas(u_volume, u_volume_size, u_atlas_tiles, place, false).CHANNELS;
#endif
}
#else
uniform sampler3D u_volume;

ivec3 volume_size() {
    return textureSize(u_volume, 0);
}

// One voxel, which must be inside.
VOXEL voxel_at(ivec3 voxel) {
    return texelFetch(u_volume, voxel, 0).CHANNELS;
}

// The sampler of a ring repeats along all axes.
vec3 within_texture(vec3 place) {
#ifdef COORDINATES
    vec3 edge = 0.5 / vec3(volume_size());
    float angle = place.ANGLE;
    place = clamp(place, edge, 1.0 - edge);
    place.ANGLE = u_ring ? angle : place.ANGLE;
#endif
    return place;
}

// Trilinear by the texture unit; beyond the outermost centres their value goes on.
VOXEL linear_voxel(vec3 place) {
    return textureLod(u_volume, within_texture(place), 0.0).CHANNELS;
}
#endif

float texel(ivec3 voxel) {
    return NUMBER(voxel_at(voxel));
}

float linear_texel(vec3 place) {
    return NUMBER(linear_voxel(place));
}

// The voxel at or below a place along each axis, and the way from its centre to the next one's, in [0, 1].
// The place is split, so that its product with a size up to 8192 is exact and the whole part costs the fraction no
// digits.
struct Cell {
    vec3 low;
    vec3 a;
};

Cell cell_at(vec3 place) {
    vec3 size = vec3(volume_size());
    vec3 coarse = floor(place * 1024.0) * (1.0 / 1024.0);
    vec3 p = coarse * size - 0.5;
    vec3 rest = (place - coarse) * size;
    vec3 low = floor(p + rest);
    vec3 a = (p - low) + rest;
    vec3 over = floor(a);  // where rounding took the sum to the next voxel
    return Cell(low + over, a - over);
}

ivec3 inside_volume(ivec3 voxel) {
    ivec3 inside = clamp(voxel, ivec3(0), volume_size() - 1);
#ifdef COORDINATES
    inside.ANGLE = on_ring(voxel.ANGLE, volume_size().ANGLE);
#endif
    return inside;
}

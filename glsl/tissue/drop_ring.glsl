#include "tissue/list.glsl"
// The ring of drops, in groups of 16 (effects/tissue/drop_ring.h). A group lies as a square of 4 x 4 texels, which a point draws.
uniform sampler2D u_living;  // places of drops that may live, four to an item
uniform int u_first;         // of a run of drops in the ring, in place of those of u_living; -1: none
uniform int u_capacity;

const int group_side = 4;

/// Groups lie in rows of 64.
int group_at(ivec2 place) {
    return place.x + (place.y << 6);
}

ivec2 group_place(int group) {
    return ivec2(group & 63, group >> 6);
}

/// Place in the ring of the n-th drop that is drawn.
int drop_place(int n) {
    int run = u_first + n;
    return u_first < 0 ? int(list_item(u_living, n >> 2)[n & 3]) : run < u_capacity ? run : run - u_capacity;
}

ivec2 drop_texel(int place) {
    return group_side * group_place(place >> 4) + ivec2(place & 3, (place >> 2) & 3);
}

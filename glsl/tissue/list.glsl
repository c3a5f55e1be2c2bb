#include "common/texel.glsl"
// A list of four floats each in rows of 1024 texels (effects/tissue/list_texture.h).
vec4 list_item(sampler2D list, int i) {
    return texel_at(list, ivec2(i & 1023, i >> 10));
}

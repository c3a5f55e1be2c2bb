// Which pixels of a picture in mixed resolution are cast; volume/mixed_fill.glsl has filled in the others.
uniform sampler2D u_plan;  // volume/mixed_plan.glsl

const int tile_size = 4;  // side of what is cast or filled in as a whole [pixels]: effects/volume/mixed.h

bool is_cast(ivec2 pixel) {
    return texelFetch(u_plan, pixel / tile_size, 0).r > 0.5;
}

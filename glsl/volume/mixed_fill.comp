#version 430 core
#include "common/compute.glsl"
#include "volume/mixed_fill.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

void main() {
    ivec2 pixel;
    if (own_pixel(pixel) && !is_cast(pixel)) {
        imageStore(u_target, pixel, fill_in(vec2(pixel) + 0.5));
    }
}

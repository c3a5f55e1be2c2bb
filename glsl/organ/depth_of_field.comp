#version 430 core
#include "common/compute.glsl"
#include "organ/depth_of_field.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

void main() {
    ivec2 pixel;
    if (own_pixel(pixel)) {
        imageStore(u_target, pixel, blurred(vec2(pixel) + 0.5));
    }
}

#version 430 core
#include "common/compute.glsl"
#include "volume/mixed_plan.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

void main() {
    ivec2 tile;
    if (own_pixel(tile)) {
        imageStore(u_target, tile, plan_tile(tile));
    }
}

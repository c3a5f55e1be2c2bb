#version 430 core
#include "common/compute.glsl"
#include "volume/ray_cast_body.glsl"
layout(local_size_x = 8, local_size_y = 4) in;

void main() {
    ivec2 pixel;
    bool wanted = own_pixel(pixel);
#ifdef MIXED_FINE
    wanted = wanted && is_cast(pixel);
#endif
    if (wanted) {
        imageStore(u_target, pixel, cast_ray(vec2(pixel) + 0.5));
    }
}

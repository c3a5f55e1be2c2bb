// Part of a slab, in [-1/2, 1/2), by which a pixel's samples are moved; the same in every frame.
#if JITTER == 2
uniform sampler2D u_blue_noise;
uniform ivec2 u_blue_noise_shift;

float jitter(ivec2 pixel) {
    ivec2 size = textureSize(u_blue_noise, 0);
    return texelFetch(u_blue_noise, (pixel + u_blue_noise_shift) & (size - 1), 0).r - 0.5;
}
#else
uniform uint u_seed;

// A permuted congruential generator's output step over the pixel's number (O'Neill, 2014).
float jitter(ivec2 pixel) {
    uint state = (uint(pixel.x) + 65536U * uint(pixel.y) + u_seed * 2654435769U) * 747796405U + 2891336453U;
    uint word = ((state >> ((state >> 28U) + 4U)) ^ state) * 277803737U;
    word = (word >> 22U) ^ word;
    return float(word >> 8U) / 16777216.0 - 0.5;
}
#endif

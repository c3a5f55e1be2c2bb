// Pixels of a picture in mixed resolution that the coarse picture is good enough for.
#include "volume/mixed_lattice.glsl"
#include "volume/mixed_choice.glsl"
#ifdef BACKGROUND
uniform vec2 u_pixel;  // size of a pixel in normalised device coordinates
#endif
#include "volume/picture.glsl"
uniform sampler2D u_coarse;

// The pixel's colour: the cubic through the 4 x 4 texels around it.
vec4 fill_in(vec2 pixel) {
    ivec2 size = textureSize(u_coarse, 0);
    vec2 at = lattice_place(pixel);
    Stencil sx = stencil(at.x, size.x, u_lattice.x);
    Stencil sy = stencil(at.y, size.y, u_lattice.y);
    // Differences to one texel are what is summed: weights whose sum is not quite 1 leave a constant as it is.
    vec4 base = texelFetch(u_coarse, ivec2(sx.nearest, sy.nearest), 0);
    vec4 sum = vec4(0.0);
    for (int j = 0; j < 4; ++j) {
        ivec2 texel = ivec2(sx.first, sy.first + j);
        mat4 row = mat4(texelFetch(u_coarse, texel, 0) - base, texelFetch(u_coarse, texel + ivec2(1, 0), 0) - base,
                        texelFetch(u_coarse, texel + ivec2(2, 0), 0) - base, texelFetch(u_coarse, texel + ivec2(3, 0), 0) - base);
        sum += sy.cubic[j] * (row * sx.cubic);
    }
    vec4 colour = base + sum;
    colour = vec4(max(colour.rgb, 0.0), clamp(colour.a, 0.0, 1.0));
#ifdef BACKGROUND
    return over_background(colour, pixel);
#else
    return colour;
#endif
}

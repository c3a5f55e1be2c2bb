// Which tiles of a picture in mixed resolution are cast, 1, and which the coarse picture is good enough for, 0: one texel for
// each tile. All pixels of a tile are cast or none: renderers compute neighbours together, and each would wait for the one
// that is cast.
#include "volume/mixed_lattice.glsl"
#include "volume/mixed_choice.glsl"
#ifdef SURFACE
#include "volume/ray.glsl"
#include "volume/picture.glsl"
#endif
uniform sampler2D u_coarse;
uniform float u_coarse_tolerance;        // of colour and opacity
uniform float u_coarse_depth_tolerance;  // [mm]

// Second difference at a texel by the divided differences of three along one axis, in units of the wider of both distances.
// 0 where there is no pixel between them.
vec4 bend_at(ivec2 texel, ivec2 axis, ivec2 size) {
    int i = texel.x * axis.x + texel.y * axis.y;
    int texels = size.x * axis.x + size.y * axis.y;
    int lines = u_lattice.x * axis.x + u_lattice.y * axis.y;
    float left = float(lattice_line(i, texels, lines) - lattice_line(i - 1, texels, lines));
    float right = float(lattice_line(i + 1, texels, lines) - lattice_line(i, texels, lines));
    vec4 here = texelFetch(u_coarse, texel, 0);
    vec4 rise = (here - texelFetch(u_coarse, texel - axis, 0)) / left;
    vec4 next = (texelFetch(u_coarse, texel + axis, 0) - here) / right;
    float unit = max(left, right);
    return unit > 1.0 ? abs((next - rise) * (2.0 * unit * unit / (left + right))) : vec4(0.0);
}

#ifdef SURFACE
float from_far(vec2 pixel) {
    return 1.0 - textureLod(u_depth, 0.5 * u_pixel * pixel, 0.0).r;
}

// How many mm of the ray a difference of depths is at this depth: surface_along() derived.
float mm_per_depth(vec2 pixel, float from_far) {
    vec4 to = u_depth_to_share;
    float below = to.z * from_far + to.w;
    return abs(to.y * to.w + to.z * to.x) / max(below * below, 1e-30) * pixel_ray(pixel).scale;
}

// How far the surface at a pixel is from where its neighbours, and the coarse picture's pixels, have it [depth]. A plane has
// a depth that is linear over the picture, whatever its slope: what differs from that is an edge or a bend.
float depth_gap(vec2 pixel, float own, ivec2 size) {
    vec2 x = vec2(1.0, 0.0);
    vec2 y = vec2(0.0, 1.0);
    vec2 beside = vec2(0.5 * (from_far(pixel - x) + from_far(pixel + x)) - own, 0.5 * (from_far(pixel - y) + from_far(pixel + y)) - own);
    // At the border of the picture there are no neighbours on either side.
    beside *= vec2(greaterThan(pixel, vec2(1.0))) * vec2(lessThan(pixel, vec2(u_size) - 1.0));
    vec2 at = lattice_place(pixel);
    Stencil sx = stencil(at.x, size.x, u_lattice.x);
    Stencil sy = stencil(at.y, size.y, u_lattice.y);
    vec2 depth = vec2(0.0);
    for (int j = 0; j < 4; ++j) {
        vec4 row;
        for (int i = 0; i < 4; ++i) {
            row[i] = 1.0 - texelFetch(u_depth, ivec2(int(sx.lines[i]), int(sy.lines[j])), 0).r - own;
        }
        depth += vec2(sy.cubic[j] * dot(row, sx.cubic), sy.linear[j] * dot(row, sx.linear));
    }
    // All are 0 on a plane, up to the rounding of depths: a few units in the last place of a depth next to 1.
    const float rounding = 4e-7;
    return max(max(abs(depth.x), abs(depth.y)), max(abs(beside.x), abs(beside.y))) - rounding;
}
#endif

vec4 plan_tile(ivec2 tile) {
    ivec2 size = textureSize(u_coarse, 0);
    ivec2 first_pixel = tile * tile_size;
    ivec2 last_pixel = min(first_pixel + tile_size, u_size) - 1;
    vec2 low = lattice_place(vec2(first_pixel) + 0.5);
    vec2 high = lattice_place(vec2(last_pixel) + 0.5);
    ivec2 first = ivec2(texel_before(low.x, size.x, u_lattice.x), texel_before(low.y, size.y, u_lattice.y));
    ivec2 last = ivec2(texel_before(high.x, size.x, u_lattice.x), texel_before(high.y, size.y, u_lattice.y));
    ivec2 last_line = ivec2(lattice_line(last.x, size.x, u_lattice.x), lattice_line(last.y, size.y, u_lattice.y));
    last += ivec2(greaterThan(high, vec2(last_line)));
    bool rough = any(lessThan(first, ivec2(0))) || any(greaterThanEqual(last, size));
    first = clamp(first, ivec2(1), size - 2);
    last = clamp(last, first, size - 2);
    // Cubic and line differ by 1/16 of the sum of the bends on either side midway. Amounts are what is added: a step's two
    // bends are of opposite sign.
    vec4 most = vec4(0.0);
    for (int y = first.y; y <= last.y; ++y) {
        for (int x = first.x; x <= last.x; ++x) {
            most = max(most, bend_at(ivec2(x, y), ivec2(1, 0), size) + bend_at(ivec2(x, y), ivec2(0, 1), size));
        }
    }
    most /= 8.0;
    // Not smooth: so that nothing is filled in that is not better than a tolerance of 0.
    rough = rough || !(max(max(most.r, most.g), max(most.b, most.a)) < u_coarse_tolerance);
#ifdef SURFACE
    // Most tiles have no surface near, and need but a look at the depth of all pixels that matter.
    float nearest = 0.0;
    int rows = rough ? 0 : last_pixel.y - first_pixel.y + 3;
    for (int y = 0; y < rows; ++y) {
        for (int x = first_pixel.x - 1; x <= last_pixel.x + 1; ++x) {
            nearest = max(nearest, from_far(vec2(x, first_pixel.y - 1 + y) + 0.5));
        }
    }
    int beyond = rough ? first.y - 2 : min(last.y + 2, size.y - 1);
    for (int y = max(first.y - 2, 0); y <= beyond; ++y) {
        for (int x = max(first.x - 2, 0); x <= min(last.x + 2, size.x - 1); ++x) {
            ivec2 line = ivec2(lattice_line(x, size.x, u_lattice.x), lattice_line(y, size.y, u_lattice.y));
            nearest = max(nearest, 1.0 - texelFetch(u_depth, line, 0).r);
        }
    }
    int last_row = nearest > 0.0 ? last_pixel.y : first_pixel.y - 1;
    for (int y = first_pixel.y; y <= last_row; ++y) {
        for (int x = first_pixel.x; x <= last_pixel.x; ++x) {
            vec2 pixel = vec2(x, y) + 0.5;
            float own = from_far(pixel);
            rough = rough || depth_gap(pixel, own, size) * mm_per_depth(pixel, own) > u_coarse_depth_tolerance;
        }
    }
#endif
    return vec4(rough ? 1.0 : 0.0);
}

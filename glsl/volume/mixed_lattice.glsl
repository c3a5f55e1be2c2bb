// A picture in mixed resolution. Each texel of the coarse picture holds the ray of one pixel of the full one: along an axis
// texel i has pixel ((2 i + 1) lines) / (2 texels). So what is copied is exact, and the depth of surfaces is known where the
// coarse rays ended.
uniform ivec2 u_lattice;  // size of the full picture [pixels]
uniform ivec2 u_size;     // of the picture that is drawn [pixels]

int lattice_line(int texel, int texels, int lines) {
    return ((2 * texel + 1) * lines) / (2 * texels);
}

#ifdef MIXED_COARSE
vec2 lattice_pixel(vec2 pixel) {
    ivec2 texel = ivec2(pixel);
    return vec2(lattice_line(texel.x, u_size.x, u_lattice.x), lattice_line(texel.y, u_size.y, u_lattice.y)) + 0.5;
}
#else
// Where the middle of a pixel that is drawn lies in the full picture: whole numbers where it has one of its pixels.
vec2 lattice_place(vec2 pixel) {
    return u_size == u_lattice ? floor(pixel) : pixel / vec2(u_size) * vec2(u_lattice) - 0.5;
}

// The last texel of an axis at or before a place, -1 where there is none.
int texel_before(float at, int texels, int lines) {
    int left = int(floor((at + 1.0) * float(texels) / float(lines) - 0.5));
    left = clamp(left, 0, texels - 1);
    left -= int(float(lattice_line(left, texels, lines)) > at);
    left += int(left + 1 < texels && float(lattice_line(left + 1, texels, lines)) <= at);
    return left;
}

// The four texels along one axis about a place and their weights in the cubic through all of them, and those of the line
// through the two next to it. Texels lie at unequal distances where the sizes have no common measure.
struct Stencil {
    int first;
    int nearest;
    vec4 lines;
    vec4 cubic;
    vec4 linear;
};

Stencil stencil(float at, int texels, int lines) {
    Stencil s;
    s.nearest = clamp(texel_before(at, texels, lines), 0, texels - 2);
    s.first = clamp(s.nearest - 1, 0, texels - 4);
    vec4 p = vec4(lattice_line(s.first, texels, lines), lattice_line(s.first + 1, texels, lines),
                  lattice_line(s.first + 2, texels, lines), lattice_line(s.first + 3, texels, lines));
    vec4 d = at - p;
    // Products in one order above and below, so that on a texel its weight is exactly 1.
    s.cubic = vec4((d.y * d.z * d.w) / ((p.x - p.y) * (p.x - p.z) * (p.x - p.w)),
                   (d.x * d.z * d.w) / ((p.y - p.x) * (p.y - p.z) * (p.y - p.w)),
                   (d.x * d.y * d.w) / ((p.z - p.x) * (p.z - p.y) * (p.z - p.w)),
                   (d.x * d.y * d.z) / ((p.w - p.x) * (p.w - p.y) * (p.w - p.z)));
    float a = float(lattice_line(s.nearest, texels, lines));
    float share = (at - a) / (float(lattice_line(s.nearest + 1, texels, lines)) - a);
    vec4 number = vec4(0.0, 1.0, 2.0, 3.0) - float(s.nearest - s.first);
    s.linear = vec4(equal(number, vec4(0.0))) * (1.0 - share) + vec4(equal(number, vec4(1.0))) * share;
    s.lines = p;
    return s;
}
#endif

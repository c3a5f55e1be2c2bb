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
#endif

#ifdef MIXED_FINE
uniform sampler2D u_coarse;
uniform float u_coarse_tolerance;        // of colour and opacity
uniform float u_coarse_depth_tolerance;  // [mm]

// The four texels along one axis between which a place lies, and their weights: those of the cubic through all four, and
// those of the line through the two next to it. Texels lie at unequal distances where the sizes have no common measure.
struct Stencil {
    int first;
    int nearest;
    vec4 cubic;
    vec4 linear;
    vec4 left_bend;   // second differences at the two texels that it lies between, in units of their distance
    vec4 right_bend;
    float between;    // 0 on a texel, 1 midway
    vec4 lines;
    bool inside;  // between the first and the last texel of the picture
};

Stencil stencil(float at, int texels, int lines) {
    int left = int(floor((at + 1.0) * float(texels) / float(lines) - 0.5));
    left = clamp(left, 0, texels - 1);
    left -= int(float(lattice_line(left, texels, lines)) > at);
    left += int(float(lattice_line(left + 1, texels, lines)) <= at);
    Stencil s;
    s.inside = left >= 0 && at <= float(lattice_line(texels - 1, texels, lines));
    left = clamp(left, 0, texels - 2);
    s.first = clamp(left - 1, 0, texels - 4);
    s.nearest = left;
    vec4 p = vec4(lattice_line(s.first, texels, lines), lattice_line(s.first + 1, texels, lines),
                  lattice_line(s.first + 2, texels, lines), lattice_line(s.first + 3, texels, lines));
    vec4 d = at - p;
    // Products in one order above and below, so that on a texel its weight is exactly 1.
    s.cubic = vec4((d.y * d.z * d.w) / ((p.x - p.y) * (p.x - p.z) * (p.x - p.w)),
                   (d.x * d.z * d.w) / ((p.y - p.x) * (p.y - p.z) * (p.y - p.w)),
                   (d.x * d.y * d.w) / ((p.z - p.x) * (p.z - p.y) * (p.z - p.w)),
                   (d.x * d.y * d.z) / ((p.w - p.x) * (p.w - p.y) * (p.w - p.z)));
    float a = float(lattice_line(left, texels, lines));
    float b = float(lattice_line(left + 1, texels, lines));
    float share = (at - a) / (b - a);
    vec4 number = vec4(0.0, 1.0, 2.0, 3.0) - float(left - s.first);
    s.linear = mix(vec4(0.0), vec4(1.0 - share), equal(number, vec4(0.0))) + mix(vec4(0.0), vec4(share), equal(number, vec4(1.0)));
    vec3 step = p.yzw - p.xyz;
    vec2 span = p.zw - p.xy;
    float unit = 2.0 * (b - a) * (b - a);
    s.left_bend = unit * vec4(1.0 / (step.x * span.x), -1.0 / (step.x * step.y), 1.0 / (step.y * span.x), 0.0);
    s.right_bend = unit * vec4(0.0, 1.0 / (step.y * span.y), -1.0 / (step.y * step.z), 1.0 / (step.z * span.y));
    s.between = 4.0 * share * (1.0 - share);
    s.lines = p;
    return s;
}

#ifdef SURFACE
// How many mm of the ray a difference of depths is at this depth: surface_along() derived.
float mm_per_depth(Ray ray, float from_far) {
    vec4 to = u_depth_to_share;
    float below = to.z * from_far + to.w;
    return abs(to.y * to.w + to.z * to.x) / max(below * below, 1e-30) * ray.scale;
}
#endif

// The pixel's colour from the coarse picture; false where that cannot tell.
bool filled_in(Ray ray, vec2 pixel, out vec4 colour) {
    ivec2 size = textureSize(u_coarse, 0);
    vec2 at = u_size == u_lattice ? floor(pixel) : pixel / vec2(u_size) * vec2(u_lattice) - 0.5;
    Stencil sx = stencil(at.x, size.x, u_lattice.x);
    Stencil sy = stencil(at.y, size.y, u_lattice.y);
    // Differences to one texel are what is summed: weights whose sum is not quite 1 leave a constant as it is.
    vec4 base = texelFetch(u_coarse, ivec2(sx.nearest, sy.nearest), 0);
    vec4 cubic = vec4(0.0);
    vec4 across = vec4(0.0);  // how much rows bend, and columns
    mat4 left_up = mat4(0.0);
    mat4 right_up = mat4(0.0);
    for (int j = 0; j < 4; ++j) {
        ivec2 texel = ivec2(sx.first, sy.first + j);
        mat4 row = mat4(texelFetch(u_coarse, texel, 0) - base, texelFetch(u_coarse, texel + ivec2(1, 0), 0) - base,
                        texelFetch(u_coarse, texel + ivec2(2, 0), 0) - base, texelFetch(u_coarse, texel + ivec2(3, 0), 0) - base);
        cubic += sy.cubic[j] * (row * sx.cubic);
        across += sy.linear[j] * (abs(row * sx.left_bend) + abs(row * sx.right_bend));
        left_up += sy.left_bend[j] * row;
        right_up += sy.right_bend[j] * row;
    }
    // Cubic and line differ by (left + right) / 16 midway. The sum of amounts is as much where the picture is smooth, but not
    // 0 on a step, whose two bends are of opposite sign.
    vec4 up = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
        up += sx.linear[i] * (abs(left_up[i]) + abs(right_up[i]));
    }
    vec4 bends = (sx.between * across + sy.between * up) / 16.0;
    bool smooth_here = max(max(bends.r, bends.g), max(bends.b, bends.a)) <= u_coarse_tolerance;
#ifdef SURFACE
    // A plane has a depth that is linear over the picture, whatever its slope: what differs from that is an edge or a bend.
    float own = 1.0 - textureLod(u_depth, 0.5 * u_pixel * pixel, 0.0).r;
    vec2 depth = vec2(0.0);
    for (int j = 0; j < 4; ++j) {
        vec4 row;
        for (int i = 0; i < 4; ++i) {
            row[i] = 1.0 - texelFetch(u_depth, ivec2(int(sx.lines[i]), int(sy.lines[j])), 0).r - own;
        }
        depth += vec2(sy.cubic[j] * dot(row, sx.cubic), sy.linear[j] * dot(row, sx.linear));
    }
    // Both are 0 on a plane, up to the rounding of depths: a few units in the last place of a depth next to 1.
    const float rounding = 4e-7;
    float bend = max(abs(depth.x), abs(depth.y)) - rounding;
    smooth_here = smooth_here && bend * mm_per_depth(ray, own) <= u_coarse_depth_tolerance;
#endif
    vec4 sum = base + cubic;
    colour = vec4(max(sum.rgb, 0.0), clamp(sum.a, 0.0, 1.0));
    return smooth_here && sx.inside && sy.inside;
}
#endif

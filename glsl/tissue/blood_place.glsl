// Where a point of texture space lies on the surface, once it has left its chart.
uniform sampler2D u_film;   // w > 0: surface; -1: gutter
uniform sampler2D u_right;  // of gutters: the texel in which the surface goes on

/// A point, in texels; z: 0 there is no surface, 1 as it was, 2 taken across a seam.
vec3 place_on_surface(vec2 texel) {
    ivec2 last = textureSize(u_film, 0) - 1;
    ivec2 at = ivec2(floor(texel));
    if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
        return vec3(texel, 0.0);
    }
    float kind = texelFetch(u_film, at, 0).w;
    if (kind >= 0.0) {
        return vec3(texel, kind > 0.0 ? 1.0 : 0.0);
    }
    // Gutters say where their centres lie. Between them the seam's map is linear; a neighbour in the same gutter gives its slope.
    vec2 centre = texelFetch(u_right, at, 0).xy + 0.5;
    vec2 offset = texel - (vec2(at) + 0.5);
    vec2 jump = centre;
    for (int axis = 0; axis < 2; ++axis) {
        ivec2 unit = axis == 0 ? ivec2(1, 0) : ivec2(0, 1);
        float along = axis == 0 ? offset.x : offset.y;
        for (int side = 1; side >= -1; side -= 2) {
            ivec2 next = clamp(at + side * unit, ivec2(0), last);
            vec2 slope = (texelFetch(u_right, next, 0).xy + 0.5 - centre) * float(side);
            if (texelFetch(u_film, next, 0).w < 0.0 && next != at && dot(slope, slope) < 9.0) {
                jump += along * slope;
                break;
            }
        }
    }
    // Beside a corner of charts the jump may miss the surface by less than a texel, and at a pole, where charts end in a point, by two.
    vec2 best = centre;
    bool found = false;
    for (int i = 0; i < 10 && !found; ++i) {
        vec2 candidate = i == 0 ? jump : centre + vec2(float((i - 1) % 3 - 1), float((i - 1) / 3 - 1)) * (i == 1 ? 0.0 : 1.0);
        found = texelFetch(u_film, clamp(ivec2(floor(candidate)), ivec2(0), last), 0).w > 0.0;
        best = found ? candidate : best;
    }
    for (int i = 0; i < 25 && !found; ++i) {
        vec2 candidate = centre + vec2(float(i % 5 - 2), float(i / 5 - 2));
        found = texelFetch(u_film, clamp(ivec2(floor(candidate)), ivec2(0), last), 0).w > 0.0;
        best = found ? candidate : best;
    }
    return vec3(best, found ? 2.0 : 0.0);
}

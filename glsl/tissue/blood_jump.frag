#version 330 core
// Where each gutter leads, for blood_place.glsl: found once for a surface, since most of what moves on it meets no gutter, and software
// renderers would look for it everywhere.
uniform sampler2D u_gutters;  // list: x, y
uniform sampler2D u_film;     // w > 0: surface; -1: gutter
uniform sampler2D u_right;    // of gutters: the texel in which the surface goes on
layout(location = 0) out vec4 o_jump;    // where its centre leads; the nearest place with a surface, -1 if there is none [texels]
layout(location = 1) out vec4 o_slopes;  // how that changes along u and along v

ivec2 last;

bool is_surface(vec2 texel) {
    ivec2 at = ivec2(floor(texel));
    return at == clamp(at, ivec2(0), last) && texelFetch(u_film, clamp(at, ivec2(0), last), 0).w > 0.0;
}

/// The seam's map is linear between the centres of gutters; a neighbour in the same gutter gives its slope.
vec2 slope_along(ivec2 unit, ivec2 at, vec2 centre) {
    for (int side = 1; side >= -1; side -= 2) {
        ivec2 next = clamp(at + side * unit, ivec2(0), last);
        vec2 slope = (texelFetch(u_right, next, 0).xy + 0.5 - centre) * float(side);
        if (texelFetch(u_film, next, 0).w < 0.0 && next != at && dot(slope, slope) < 9.0) {
            return slope;
        }
    }
    return vec2(0.0);
}

void main() {
    last = textureSize(u_film, 0) - 1;
    ivec2 at = ivec2(texelFetch(u_gutters, ivec2(gl_FragCoord.xy), 0).xy);
    vec2 centre = texelFetch(u_right, at, 0).xy + 0.5;
    // Beside a corner of charts a jump may miss the surface by less than a texel, and at a pole, where charts end in a point, by two.
    vec2 other = vec2(-1.0);
    float nearest = 9.0;
    for (int i = 0; i < 25; ++i) {
        vec2 away = vec2(float(i % 5 - 2), float(i / 5 - 2));
        if (dot(away, away) < nearest && is_surface(centre + away)) {
            nearest = dot(away, away);
            other = centre + away;
        }
    }
    o_jump = vec4(centre, other);
    o_slopes = vec4(slope_along(ivec2(1, 0), at, centre), slope_along(ivec2(0, 1), at, centre));
}

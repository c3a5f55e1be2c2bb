// Relief by the surface's gradient in screen space (Mikkelsen, "Bump Mapping Unparametrized Surfaces on the GPU", 2010). It needs
// no tangents, so mirrored and turned texture coordinates turn nothing in the world.
#include "common/unit.glsl"

// n: unit normal; px, py: steps of the surface from pixel to pixel; rise: of the height over the same steps. Without a rise, and
// where the surface is seen edge on or n is none, n itself, to the bit.
vec3 bumped(vec3 n, vec3 px, vec3 py, vec2 rise) {
    vec3 r1 = cross(py, n);
    vec3 r2 = cross(n, px);
    float det = dot(px, r1);
    vec3 gradient = sign(det) * (rise.x * r1 + rise.y * r2);
    if (det == 0.0 || gradient == vec3(0.0)) {
        return n;
    }
    // det is an area, which is tiny for small pixels: scaled before it is squared.
    vec3 steepness = abs(gradient);
    float size = max(abs(det), max(steepness.x, max(steepness.y, steepness.z)));
    return unit((abs(det) * n - gradient) / size);
}

// Slopes along u and v from a tangent-space normal; none where it does not point outwards.
vec2 slopes_of(vec3 normal) {
    return normal.z > 1e-3 && dot(normal, normal) < 1e6 ? -normal.xy / normal.z : vec2(0.0);
}

// Rise of the height over the steps px and py for slopes that count in lengths along the directions of u and v; along_x and along_y:
// the steps of (u, v). Lengths come from the steps themselves, so a stretched texture makes no relief steeper. Without texture
// coordinates of any extent there is none.
vec2 rise_of(vec2 slopes, vec3 px, vec3 py, vec2 along_x, vec2 along_y) {
    float det = abs(along_x.x * along_y.y - along_x.y * along_y.x);
    vec2 lengths = vec2(length(px * along_y.y - py * along_x.y), length(py * along_x.x - px * along_y.x));
    vec2 per_unit = det > 0.0 ? slopes * lengths / det : vec2(0.0);
    return vec2(dot(per_unit, along_x), dot(per_unit, along_y));
}

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

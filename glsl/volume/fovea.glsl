// How many times as long the slabs of a pixel's ray are as those where one looks: 1 within the inner radius, from there
// growing without a step up to the factor at the outer one. Each ray has one lattice, so that no sample depends on where
// leaping or stopping happens; from ray to ray the lattice changes so little that no ring is seen.
uniform vec2 u_fovea_centre;  // UV
uniform vec4 u_fovea;         // picture's width over height, inner radius, outer radius (shares of the height), factor - 1

float fovea_factor(vec2 pixel) {
    vec2 away = (0.5 * u_pixel * pixel - u_fovea_centre) * vec2(u_fovea.x, 1.0);
    return 1.0 + u_fovea.w * smoothstep(u_fovea.y, u_fovea.z, length(away));
}

// A film is a texture with a texel per place: height [mm], what is owed to the height [mm], what has left [mm], area [mm^2].
// Area > 0: a cell of the surface; -1: a gutter, where the surface goes on across a seam; 0: nothing.
// A step of the solver is a finite-volume one: what leaves a cell through a face enters the next. Both sides of a face find the same
// volume, because both do the same operations on the same numbers.
uniform vec4 u_flow;  // mobility [1/(mm s)], residual film [mm], time step [s], drying [mm/s]

const float share_of_a_face = 0.25;

/// Volume that goes from a to b in one step [mm^3]; negative the other way. Limits hold in films that are too thick for the step: no cell
/// gives more than it holds, and levelling never overshoots. area: of the smaller cell, times four times the face's share of what leaves.
float exchange(float drive, float spread, float area, float a, float b) {
    float moving = max((drive > 0.0 ? a : b) - u_flow.y, 0.0);
    float limit = area / (8.0 * u_flow.z * max(spread, 1e-6));
    float mobility = min(u_flow.x * (1.0 / 3.0) * moving * moving * moving, limit);
    float most = share_of_a_face * moving * area;
    return clamp(u_flow.z * mobility * drive, -most, most);
}

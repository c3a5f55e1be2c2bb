// A film is a texture with a texel per place: height [mm], what is owed to the height [mm], what has left [mm], area [mm^2].
// Area > 0: a cell of the surface; -1: a gutter, where the surface goes on across a seam; 0: nothing, or a cell that has collapsed: what
// lay on it waits there as volumes [mm^3] in place of heights.
// A step of the solver is a finite-volume one: what leaves a cell through a face enters the next. Both sides of a face find the same
// volume, because both do the same operations on the same numbers.
uniform vec4 u_flow;      // mobility [1/(mm s)], residual film [mm], time step [s], drying [mm/s]
uniform float u_pinning;  // height over the residual film that spreads over dry tissue [mm]

const float share_of_a_face = 0.25;

/// Volume that goes from a to b in one step [mm^3]; negative the other way. It grows with the height by its cube, up to the height from
/// which on more than the face's share of what comes would leave in the same step, and linearly from there: beyond, cells would overshoot
/// each other in stripes. So waves pass no more than a cell in a step, no cell gives more than it holds, and levelling never overshoots.
/// The edge of a film is pinned until it is high enough; where a quarter of that has come, the tissue is wet.
/// area: of the smaller cell, times four times the face's share of what leaves.
float exchange(float drive, float spread, float area, float a, float b) {
    float pinned = max(u_pinning - 4.0 * (drive > 0.0 ? b : a), 0.0);
    float moving = max((drive > 0.0 ? a : b) - u_flow.y - pinned, 0.0);
    float pull = u_flow.z * u_flow.x * (1.0 / 3.0) * abs(drive);
    float most = share_of_a_face * area;
    float steepness = 3.0 * pull * moving * moving;
    float volume = steepness > most ? most * (moving - (2.0 / 3.0) * sqrt(most / (3.0 * pull))) : pull * moving * moving * moving;
    volume = min(volume, abs(drive) * area / (8.0 * max(spread, 1e-6)));
    return drive > 0.0 ? volume : -volume;
}

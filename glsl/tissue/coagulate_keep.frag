#version 330 core
// Squares of texels that no contact reaches, in rectangles around some that contacts do.
#include "tissue/energy_store.glsl"
layout(location = 0) out float o_energy;

void main() {
    o_energy = storable(last_energy());
}

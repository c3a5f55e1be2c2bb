// The energy's target, as it was after the last frame and as it can be kept.
uniform sampler2D u_last;
uniform float u_size;  // texels along each side of the target
uniform float u_keep;  // 0: begin with nothing
uniform bool u_half;   // the target holds half floats

// The last content may be a single black texel, so it is looked up by coordinates.
float last_energy() {
    return u_keep * textureLod(u_last, gl_FragCoord.xy / u_size, 0.0).r;
}

// Within what a half float holds, with room to spare. Software renderers cut the digits off that a half float has no room for. A
// state would creep towards 0 with each increment that is too small for it, so it is rounded to nearest here.
float storable(float e) {
    const float largest_energy = 60000.0;
    float kept = clamp(e, -largest_energy, largest_energy);
    uint bits = floatBitsToUint(kept);
    uint nearest = (bits + 0x0fffu + ((bits >> 13) & 1u)) & ~0x1fffu;
    return u_half ? uintBitsToFloat(nearest) : kept;
}

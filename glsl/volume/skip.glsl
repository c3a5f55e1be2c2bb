// Runs of slabs that lie in bricks of one kind, from the signed distances of effects/volume/bricks.h: nothing is to be
// seen in an empty run, whatever the ray function, so it can be left out.
uniform usampler3D u_bricks;     // distance to the nearest brick of the other kind; + 128: occupied
uniform vec3 u_bricks_per_unit;  // bricks per texture coordinate

struct Leaper {
    vec3 first;    // position of slab 0's start [bricks]
    vec3 extent;   // per slab
    vec3 inverse;
    ivec3 last;    // last brick
};

struct Run {
    int end;  // first slab behind it
    bool occupied;
};

Leaper make_leaper(vec3 first, vec3 extent) {
    vec3 e = extent * u_bricks_per_unit;
    return Leaper(first * u_bricks_per_unit, e, reciprocal(e), textureSize(u_bricks, 0) - 1);
}

// A slab belongs to the brick of its centre; the brick's range covers the whole slab, since its border is that wide.
Run run_from(Leaper leaper, int k, int count) {
    vec3 place = leaper.first + (float(k) + 0.5) * leaper.extent;
    ivec3 brick = clamp(ivec3(floor(place)), ivec3(0), leaper.last);
    uint entry = texelFetch(u_bricks, brick, 0).r;
    float reach = float(entry & 127u);
    vec3 low = vec3(brick) - (reach - 1.0);
    vec3 high = vec3(brick) + reach;
    vec3 leave = (mix(low, high, greaterThan(leaper.extent, vec3(0.0))) - place) * leaper.inverse;
    float slabs = min(min(leave.x, leave.y), leave.z);
    return Run(min(k + 1 + int(clamp(slabs, 0.0, float(count))), count), entry > 127u);
}

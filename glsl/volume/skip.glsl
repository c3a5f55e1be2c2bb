// Runs of slabs that lie in bricks of one kind, from the cubes of effects/volume/brick_distances.h that lie ahead of a ray:
// nothing is to be seen in an empty run, whatever the ray function, so it can be left out.
uniform usampler3D u_bricks;     // kind * 32 + size of the cube of bricks of that kind: one block for each way to go
uniform vec3 u_bricks_per_unit;  // bricks per texture coordinate
uniform vec3 u_occupied_low;     // box around all bricks that are not empty [bricks]
uniform vec3 u_occupied_high;

const uint run_empty = 0U;
const uint run_full = 1U;    // every slab is sampled
// 1 + i: the transfer function hardly changes here, slabs of 4^i do

struct Leaper {
    vec3 first;    // position of the march's start [bricks], in the block of the ray's way
    vec3 extent;   // per unit of the march
    vec3 inverse;
    vec3 way;      // of one brick along each axis, in units of the march
    vec3 base;     // where the march is at the faces ahead of brick 0's middle
    ivec3 low;     // first and last brick of the block
    ivec3 high;
};

struct Run {
    float extent;  // from the place asked for to the end of the run, in units of the march
    uint kind;
};

Leaper make_leaper(vec3 first, vec3 extent) {
    vec3 e = extent * u_bricks_per_unit;
    ivec3 bricks = textureSize(u_bricks, 0) / 2;
    ivec3 low = bricks * ivec3(greaterThan(e, vec3(0.0)));
    vec3 start = first * u_bricks_per_unit + vec3(low);
    vec3 inverse = reciprocal(e);
    vec3 way = abs(inverse);
    return Leaper(start, e, inverse, way, (0.5 - start) * inverse - 0.5 * way, low, low + bricks - 1);
}

Run run_from(Leaper leaper, float at) {
    // Rounding may put a place outside the block.
    ivec3 brick = clamp(ivec3(leaper.first + at * leaper.extent), leaper.low, leaper.high);
    uint entry = texelFetch(u_bricks, brick, 0).r;
    float size = float(entry & 31u);
    vec3 leave = vec3(brick) * leaper.inverse + (size * leaper.way + leaper.base);
    return Run(max(min(min(leave.x, leave.y), leave.z) - at, 0.0), entry >> 5);
}

// Where the march enters and leaves the box around everything that is to be seen.
vec2 occupied_span(Leaper leaper) {
    vec3 a = (u_occupied_low + vec3(leaper.low) - leaper.first) * leaper.inverse;
    vec3 b = (u_occupied_high + vec3(leaper.low) - leaper.first) * leaper.inverse;
    vec3 slack = 1e24 * vec3(lessThan(abs(leaper.extent), vec3(1e-30)));  // as in the box's own interval
    vec3 enter = min(a, b) - slack;
    vec3 leave = max(a, b) + slack;
    return vec2(max(max(enter.x, enter.y), enter.z), min(min(leave.x, leave.y), leave.z));
}

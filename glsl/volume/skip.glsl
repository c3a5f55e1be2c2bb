// Runs of slabs that lie in bricks of one kind, from the distances of effects/volume/skip_map.h: nothing is to be seen
// in an empty run, whatever the ray function, so it can be left out.
uniform usampler3D u_bricks;     // kind * 32 + distance to the nearest brick of another kind
uniform vec3 u_bricks_per_unit;  // bricks per texture coordinate
uniform vec3 u_occupied_low;     // box around all bricks that are not empty [bricks]
uniform vec3 u_occupied_high;

const uint run_empty = 0U;
const uint run_full = 1U;    // every slab is sampled
// 1 + i: the transfer function hardly changes here, slabs of 4^i do

struct Leaper {
    vec3 first;    // position of the march's start [bricks]
    vec3 extent;   // per unit of the march
    vec3 inverse;
    ivec3 last;    // last brick
};

struct Run {
    float extent;  // from the place asked for to the end of the run, in units of the march
    uint kind;
};

Leaper make_leaper(vec3 first, vec3 extent) {
    vec3 e = extent * u_bricks_per_unit;
    return Leaper(first * u_bricks_per_unit, e, reciprocal(e), textureSize(u_bricks, 0) - 1);
}

Run run_from(Leaper leaper, float at) {
    vec3 place = leaper.first + at * leaper.extent;
    ivec3 brick = clamp(ivec3(floor(place)), ivec3(0), leaper.last);
    uint entry = texelFetch(u_bricks, brick, 0).r;
    float reach = float(entry & 31u);
    vec3 low = vec3(brick) - (reach - 1.0);
    vec3 high = vec3(brick) + reach;
    vec3 leave = (mix(low, high, greaterThan(leaper.extent, vec3(0.0))) - place) * leaper.inverse;
    return Run(max(min(min(leave.x, leave.y), leave.z), 0.0), entry >> 5);
}

// Where the march enters and leaves the box around everything that is to be seen.
vec2 occupied_span(Leaper leaper) {
    vec3 a = (u_occupied_low - leaper.first) * leaper.inverse;
    vec3 b = (u_occupied_high - leaper.first) * leaper.inverse;
    vec3 slack = 1e24 * vec3(lessThan(abs(leaper.extent), vec3(1e-30)));  // as in the box's own interval
    vec3 enter = min(a, b) - slack;
    vec3 leave = max(a, b) + slack;
    return vec2(max(max(enter.x, enter.y), enter.z), min(min(leave.x, leave.y), leave.z));
}

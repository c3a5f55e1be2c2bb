// Surfaces of constant value: every crossing, in order along the ray, until the ray is opaque. Inside a trilinear cell the
// field is a cubic along the ray, whose roots are found without missing any; with other filters the cubic through four
// values stands for it, and the root is then refined on the field itself.
uniform float u_iso[ISO_VALUES];         // texel values
uniform vec4 u_iso_colour[ISO_VALUES];   // colour and opacity
uniform vec4 u_lighting;                 // ambient, diffuse, specular, shininess: a light at the eye
uniform float u_transmittance_limit;

struct State {
    vec3 colour;
    float transmittance;
    float last;  // value at the end of the slab before
    float end;   // where that was [mm]
};

State begin() {
    return State(vec3(0.0), 1.0, 0.0, -3e38);
}

// The first root of cubic = value behind `from`, in (from, 1]; 2 where there is none.
float first_root(vec4 cubic, float value, float from) {
    vec4 b = cubic - value;
    if (min(min(b.x, b.y), min(b.z, b.w)) > 0.0 || max(max(b.x, b.y), max(b.z, b.w)) < 0.0) {
        return 2.0;
    }
    // Between its turns the cubic is monotonous: a change of sign there is one root.
    vec2 turns = max(cubic_turns(b), from);
    vec4 at = vec4(from, turns, 1.0);
    vec4 f = vec4(cubic_value(b, at.x), cubic_value(b, at.y), cubic_value(b, at.z), b.w);
    // The start belongs to the piece before, so that a crossing on a face counts once.
    bvec3 change = bvec3((f.x < 0.0) != (f.y < 0.0), (f.y < 0.0) != (f.z < 0.0), (f.z < 0.0) != (f.w < 0.0));
    vec2 bracket = change.x ? at.xy : (change.y ? at.yz : at.zw);
    if (!any(change)) {
        return 2.0;
    }
    bool rises = change.x ? f.x < 0.0 : (change.y ? f.y < 0.0 : f.z < 0.0);
    // Halving needs no care: 24 of them reach the last bit.
    for (int i = 0; i < 24; ++i) {
        float middle = 0.5 * (bracket.x + bracket.y);
        bool before = (cubic_value(b, middle) < 0.0) == rises;
        bracket = before ? vec2(middle, bracket.y) : vec2(bracket.x, middle);
    }
    return 0.5 * (bracket.x + bracket.y);
}

// Blinn-Phong with the light at the eye, where half-way vector and view coincide: N.V is the slope of the value along the
// ray over the whole gradient's.
vec3 lit_by_eye(vec3 colour, vec3 local, vec3 direction) {
    vec3 gradient = sample_gradient(to_sample(local));
#ifdef COORDINATES
    vec3 world = metric(gradient, local);
    float steepness = length(world);
    float along = abs(dot(world, view_direction));
#else
    float steepness = length(metric(gradient, local));
    float along = abs(dot(gradient, direction));
#endif
    float cosine = steepness > 0.0 ? min(along / steepness, 1.0) : 0.0;
    return colour * (u_lighting.x + u_lighting.y * cosine) + u_lighting.z * pow(max(cosine, 1e-6), u_lighting.w);
}

#ifdef COORDINATES
// A slab of a curvilinear volume is no cell: the cubic through four of its values only says where to look. The crossing lies
// in the third of the slab in which the values change sign, or between the start of the cubic's turn and the turn, if the
// field agrees that it goes beyond the value there; else nothing crosses. Illinois steps find it within 1e-3 of the slab
// and far closer on smooth fields. 2: no crossing.
float confirmed(Slab slab, vec4 cubic, float value, float root, float from) {
    vec3 begin = slab.centre - 0.5 * slab.extent;
    float low = max(floor(root * 3.0) * (1.0 / 3.0), from);
    float high = min(low + 1.0 / 3.0, 1.0);
    float f_low = sample_volume(to_sample(begin + low * slab.extent)) - value;
    float f_high = sample_volume(to_sample(begin + high * slab.extent)) - value;
    vec2 turns = cubic_turns(cubic);
    float turn = turns.x > root ? turns.x : turns.y;
    float f_turn = sample_volume(to_sample(begin + turn * slab.extent)) - value;
    bool twice = (f_low < 0.0) == (f_high < 0.0) && turn > low && turn < high;
    high = twice ? turn : high;
    f_high = twice ? f_turn : f_high;
    if ((f_low < 0.0) == (f_high < 0.0)) {
        return 2.0;
    }
    float last = 0.0;
    for (int i = 0; i < 8; ++i) {
        float middle = clamp(low - f_low * (high - low) / (f_high - f_low), low, high);
        float f = sample_volume(to_sample(begin + middle * slab.extent)) - value;
        bool before = (f < 0.0) == (f_low < 0.0);
        // What stays on its side twice counts half, or one end would never move.
        f_high = before && last > 0.0 ? 0.5 * f_high : f_high;
        f_low = !before && last < 0.0 ? 0.5 * f_low : f_low;
        last = before ? 1.0 : -1.0;
        low = before ? middle : low;
        f_low = before ? f : f_low;
        high = before ? high : middle;
        f_high = before ? f_high : f;
    }
    return last > 0.0 ? low : high;
}
#elif defined(REFINE)
// The filter is no cubic in its cells, the cubic only stands for it: three steps of regula falsi on the field itself, inside a bracket around the root.
float refined(Slab slab, float value, float root, float from) {
    vec3 begin = slab.centre - 0.5 * slab.extent;
    float low = max(root - 0.05, from);
    float high = min(root + 0.05, 1.0);
    float f_low = sample_volume(to_sample(begin + low * slab.extent)) - value;
    float f_high = sample_volume(to_sample(begin + high * slab.extent)) - value;
    // Where the ray grazes the surface, both ends may lie on one side: the cubic's root is the better one then.
    bool brackets = (f_low < 0.0) != (f_high < 0.0);
    for (int i = 0; i < 3; ++i) {
        float rise = f_high - f_low;
        float middle = brackets ? clamp(low - f_low * (high - low) / rise, low, high) : root;
        float f = sample_volume(to_sample(begin + middle * slab.extent)) - value;
        bool before = (f < 0.0) == (f_low < 0.0);
        low = before ? middle : low;
        f_low = before ? f : f_low;
        high = before ? high : middle;
        f_high = before ? f_high : f;
        root = middle;
    }
    return root;
}
#endif

bool take_slab(inout State state, Slab slab) {
    vec4 cubic = cell_cubic(slab);
    // Both sides of a face must see one value there, or a root could fall between two roundings of it.
    float begin_s = slab.s - 0.5 * slab.length_mm;
    cubic.x = abs(begin_s - state.end) <= 1e-4 * slab.length_mm ? state.last : cubic.x;
    state.last = cubic.w;
    state.end = begin_s + slab.length_mm;
    float least = min(min(cubic.x, cubic.y), min(cubic.z, cubic.w));
    float most = max(max(cubic.x, cubic.y), max(cubic.z, cubic.w));
    bool crosses = false;
    for (int i = 0; i < ISO_VALUES; ++i) {
        crosses = crosses || (least <= u_iso[i] && u_iso[i] <= most);
    }
    float from = 0.0;
    // A loop and not an `if`: software renderers run both sides of a branch but leave a loop that no pixel needs.
    for (int crossing = 0; crosses && crossing < 3 * ISO_VALUES; ++crossing) {
        float root = 2.0;
        int surface = 0;
        for (int i = 0; i < ISO_VALUES; ++i) {
            float r = first_root(cubic, u_iso[i], from);
            surface = r < root ? i : surface;
            root = min(r, root);
        }
        crosses = root <= 1.0;
        if (crosses) {
            float exact = root;
#ifdef COORDINATES
            exact = confirmed(slab, cubic, u_iso[surface], root, from);
            from = (exact > 1.0 ? root : max(root, exact)) + 1e-5;
            if (exact > 1.0) {
                continue;
            }
#elif defined(REFINE)
            exact = refined(slab, u_iso[surface], root, from);
#endif
            vec3 local = slab.centre + (exact - 0.5) * slab.extent;
            vec4 surface_colour = u_iso_colour[surface];
#ifdef LABELS
            vec4 in_segment = labelled(vec4(surface_colour.rgb, 1.0), label_at(local));
            surface_colour = vec4(in_segment.rgb, in_segment.a > 0.0 ? surface_colour.a : 0.0);
#endif
            vec3 lit = lit_by_eye(surface_colour.rgb, local, slab.extent / slab.length_mm);
            state.colour += state.transmittance * surface_colour.a * lit;
            state.transmittance *= 1.0 - surface_colour.a;
#ifndef COORDINATES
            from = root + 1e-5;
#endif
            crosses = state.transmittance > u_transmittance_limit;
        }
    }
    return state.transmittance <= u_transmittance_limit;
}

vec4 finish(State state) {
    return vec4(state.colour, 1.0 - state.transmittance);
}

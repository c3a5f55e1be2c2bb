// Walks one interval of a ray from face to face of the trilinear cells: inside a cell the field along the ray is a cubic,
// so that two Gauss points integrate it exactly and four samples give all of its roots and extremes.
uniform vec3 u_voxels;  // voxels per axis
uniform int u_slab_limit;

struct Walk {
    vec3 first;  // start of the interval [voxels], faces between cells at whole numbers
    vec3 rate;   // [voxels/mm]
    vec3 inverse;
    vec3 turn;   // +-1
    vec3 face;   // next face per axis
    float t;     // [mm] from the interval's start
};

// A face's time comes from its number, never by adding up: the same cell comes out the same however it was reached.
vec3 face_times(Walk walk) {
    return (walk.face - walk.first) * walk.inverse;
}

void find_faces(inout Walk walk, float t) {
    vec3 place = walk.first + t * walk.rate;
    walk.face = mix(ceil(place) - 1.0, floor(place) + 1.0, greaterThan(walk.turn, vec3(0.0)));
}

Walk start_walk(Ray ray, vec3 first) {
    Walk walk;
    walk.first = first * u_voxels - 0.5;
    walk.rate = ray.direction * u_voxels;
    walk.inverse = reciprocal(walk.rate);
    walk.turn = mix(vec3(-1.0), vec3(1.0), greaterThanEqual(walk.rate, vec3(0.0)));
    walk.t = 0.0;
    find_faces(walk, 0.0);
    return walk;
}

float cell_end(Walk walk, float length_mm) {
    vec3 times = face_times(walk);
    return max(min(min(min(times.x, times.y), times.z), length_mm), walk.t);
}

// Walks to the end of the cell; gives the slab that was crossed.
Slab next_cell(Ray ray, float start, vec3 first, float length_mm, inout Walk walk) {
    float leave = cell_end(walk, length_mm);
    walk.face += walk.turn * vec3(lessThanEqual(face_times(walk), vec3(leave)));
    float piece = leave - walk.t;
    float middle = walk.t + 0.5 * piece;
    walk.t = leave;
    return Slab(first + middle * ray.direction, piece * ray.direction, piece, start + middle);
}

#ifdef SKIP
// On to the beginning of the cell that holds a place: cells are taken whole or not at all.
Walk leap(Walk walk, float t, float length_mm) {
    find_faces(walk, t);
    vec3 entered = (walk.face - walk.turn - walk.first) * walk.inverse;
    walk.t = t >= length_mm ? length_mm : max(max(max(entered.x, entered.y), entered.z), 0.0);
    return walk;
}
#endif

void march(Ray ray, vec2 interval, float offset, inout State state) {
    float length_mm = interval.y - interval.x;
    if (!(length_mm > 0.0)) {
        return;
    }
    vec3 first = ray.origin + interval.x * ray.direction;
    Walk walk = start_walk(ray, first);
    int turns = 0;
#ifdef SKIP
    Leaper leaper = make_leaper(first, ray.direction);
    vec2 span = occupied_span(leaper);
    if (span.x >= span.y) {
        return;
    }
    walk = span.x > 0.0 ? leap(walk, span.x, length_mm) : walk;
    while (walk.t < length_mm && turns < u_slab_limit) {
        float end = length_mm;
        while (walk.t < length_mm && turns < u_slab_limit) {
            ++turns;
            // A cell belongs to the brick of its middle, whose border covers all of its corners.
            float middle = 0.5 * (walk.t + cell_end(walk, length_mm));
            Run run = run_from(leaper, middle);
            end = middle + run.extent;
            if (run.kind != run_empty) {
                break;
            }
            Walk ahead = leap(walk, end, length_mm);
            next_cell(ray, interval.x, first, length_mm, walk);
            if (ahead.t > walk.t) {
                walk = ahead;
            }
        }
        while (walk.t < min(end, length_mm) && turns < u_slab_limit) {
            ++turns;
            if (take_slab(state, next_cell(ray, interval.x, first, length_mm, walk))) {
                walk.t = length_mm;
                break;
            }
        }
    }
#else
    while (walk.t < length_mm && turns < u_slab_limit) {
        ++turns;
        if (take_slab(state, next_cell(ray, interval.x, first, length_mm, walk))) {
            break;
        }
    }
#endif
}

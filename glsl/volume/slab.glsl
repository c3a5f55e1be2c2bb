// A piece of a ray.
struct Slab {
    vec3 centre;   // local coordinates
    vec3 extent;   // from its start to its end
    float length_mm;
    float s;       // of the centre, from the ray's origin [mm]
};

// Gauss points lie this share of a slab before and behind its centre: 1 / (2 sqrt 3).
const float gauss_point = 0.28867513459481287;

// A piece of a ray.
struct Slab {
    vec3 centre;   // local coordinates
    vec3 extent;   // from its start to its end
    float length;  // [mm]
    float s;       // of the centre, from the ray's origin [mm]
};

// What a relief that is finer than the mesh does to a film: its hollows draw it in. RELIEF: there is one.
#ifdef RELIEF
uniform sampler2D u_relief;    // height over the mesh [mm]
uniform float u_relief_pull;  // share of gravity that draws into hollows

float lift(ivec2 at) {
    float height = textureLod(u_relief, (vec2(at) + 0.5) / vec2(textureSize(u_position, 0)), 0.0).r;
    return abs(height) < 1e4 ? u_relief_pull * height : 0.0;
}
#endif

/// What the relief adds to the rise from a texel to another that lies a way off in space [mm]: no more than up a wall, with which the
/// search for blood that runs reckons.
float relief_rise(ivec2 from, ivec2 to, vec3 way) {
#ifdef RELIEF
    float steepest = length(way);
    return clamp(lift(to) - lift(from), -steepest, steepest);
#else
    return 0.0;
#endif
}

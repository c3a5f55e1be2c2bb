// Depth of field as a gather: each pixel is the mean of a disc as large as its own blurriness. What lies behind it counts in full;
// what lies before it counts as far as its own disc reaches, so that a sharp edge in front is not smeared over what is blurred.
uniform sampler2D u_picture;   // colour, blurriness b as b/2 + 1/2: b rises with depth and is 0 at the focal plane
uniform float u_radius;        // [pixels] at |b| = 1
uniform vec2 u_spiral[TAPS];   // the first n of them fill a disc of radius sqrt(n) evenly, whatever n is

// A host's picture may hold anything.
bool usable(vec4 texel) {
    return dot(abs(texel), vec4(1.0)) < 1e30;
}

// As many as leave no more of a picture's noise than TAPS of them leave in a wide disc: a small one has fewer pixels to miss.
int taps_within(float radius) {
    float pixels = 3.14159265 * (radius + 1.75) * (radius + 1.75) * max(1.0, float(TAPS) / 24.0 - 1.0);
    // Sharp pixels take no turn of the loop: it ends where all pixels of a group are sharp.
    return radius < 0.5 ? 0 : int(ceil(float(TAPS) * pixels / (float(TAPS) + pixels)));
}

// Mean of the disc around a pixel, from so many places. `guarded`: leaves out what is not usable, which costs a fragment shader a quarter
// more.
vec4 gathered(vec2 centre, vec4 here, int count, bool guarded) {
    ivec2 last = textureSize(u_picture, 0) - 1;
    float radius = abs(2.0 * here.a - 1.0) * u_radius;
    float spread = radius * inversesqrt(max(float(count), 1.0));
    vec3 sum = here.rgb;
    float weights = 1.0;
    for (int i = 0; i < count; ++i) {
        vec2 way = spread * u_spiral[i];
        // Texels, not a mix of them: between two depths there is none.
        vec4 there = texelFetch(u_picture, clamp(ivec2(floor(centre + way)), ivec2(0), last), 0);
        float reach = clamp(abs(2.0 * there.a - 1.0) * u_radius - length(way) + 1.0, 0.0, 1.0);
        float weight = there.a >= here.a ? 1.0 : reach;
        bool counts = !guarded || usable(there);
        sum += counts ? weight * there.rgb : vec3(0.0);
        weights += counts ? weight : 0.0;
    }
    return vec4(sum / weights, here.a);
}

// Of the pixel whose centre is at `centre` [pixels].
vec4 blurred(vec2 centre) {
    vec4 here = texelFetch(u_picture, ivec2(centre), 0);
    here = usable(here) ? vec4(here.rgb, clamp(here.a, 0.0, 1.0)) : vec4(0.0, 0.0, 0.0, 0.5);
    int count = taps_within(abs(2.0 * here.a - 1.0) * u_radius);
    vec4 mean = gathered(centre, here, count, false);
    // One that is no number spoils the mean, which is then taken again. Elsewhere the second loop takes no turn.
    bool spoilt = !usable(mean);
    vec4 again = gathered(centre, here, spoilt ? count : 0, true);
    return spoilt ? again : mean;
}

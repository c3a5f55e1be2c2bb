#version 330 core
// Depth of field as a gather: each pixel is the mean of a disc as large as its own blurriness. What lies behind it counts in full;
// what lies before it counts as far as its own disc reaches, so that a sharp edge in front is not smeared over what is blurred.
uniform sampler2D u_picture;   // colour, blurriness b as b/2 + 1/2: b rises with depth and is 0 at the focal plane
uniform float u_radius;        // [pixels] at |b| = 1
uniform vec2 u_taps[TAPS];     // places in the unit disc
layout(location = 0) out vec4 o_colour;

// A host's picture may hold anything.
bool usable(vec4 texel) {
    return dot(abs(texel), vec4(1.0)) < 1e30;
}

void main() {
    ivec2 last = textureSize(u_picture, 0) - 1;
    vec4 here = texelFetch(u_picture, ivec2(gl_FragCoord.xy), 0);
    here = usable(here) ? vec4(here.rgb, clamp(here.a, 0.0, 1.0)) : vec4(0.0, 0.0, 0.0, 0.5);
    float radius = abs(2.0 * here.a - 1.0) * u_radius;
    // Sharp pixels take no turn of the loop: it ends where all pixels of a group are sharp.
    int count = radius < 0.5 ? 0 : TAPS;
    vec3 sum = here.rgb;
    float weights = 1.0;
    for (int i = 0; i < count; ++i) {
        vec2 way = radius * u_taps[i];
        // Texels, not a mix of them: between two depths there is none.
        vec4 there = texelFetch(u_picture, clamp(ivec2(floor(gl_FragCoord.xy + way)), ivec2(0), last), 0);
        float reach = clamp(abs(2.0 * there.a - 1.0) * u_radius - length(way) + 1.0, 0.0, 1.0);
        float weight = there.a >= here.a ? 1.0 : reach;
        sum += weight * there.rgb;
        weights += weight;
    }
    vec4 mean = vec4(sum / weights, here.a);
    o_colour = usable(mean) ? mean : here;
}

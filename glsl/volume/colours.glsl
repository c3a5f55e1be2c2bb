// Accumulation of colours as they are (COLOURS): effects/volume/colours.h.
uniform float u_colour_scale;    // texel -> share of the range
uniform vec4 u_colour_low;       // what leaves these in any channel is dropped
uniform vec4 u_colour_high;
uniform vec2 u_colour_opacity;   // opacity of opacity 1 in a reference length, and 1 / that length [1/mm]
uniform vec2 u_colour_contrast;  // brightness and contrast

// -log(1 - x): the logarithm of a number next to 1 has lost the digits of a small opacity, so that the series of the inverse
// hyperbolic tangent stands for it, off by 1e-11 at 0.1.
float depth_of_opacity(float x) {
    float s = x / (2.0 - x);
    float s2 = s * s;
    float small = 2.0 * s * (1.0 + s2 * (1.0 / 3.0 + s2 * (0.2 + s2 * (1.0 / 7.0))));
    return x < 0.1 ? small : -log(1.0 - min(x, 1.0 - 5.9604645e-8));
}

// Colour and extinction [1/mm].
vec4 colour_material(vec3 place) {
    vec4 c = u_colour_scale * sample_colour(place);
    bool kept = all(greaterThanEqual(c, u_colour_low)) && all(lessThanEqual(c, u_colour_high));
    float depth = depth_of_opacity(clamp(c.a * u_colour_opacity.x, 0.0, 1.0));
    vec3 colour = clamp((c.rgb + u_colour_contrast.x) * u_colour_contrast.y, 0.0, 1.0);
    return vec4(colour, kept ? depth * u_colour_opacity.y : 0.0);
}

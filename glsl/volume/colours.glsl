// A volume of colours instead of values: effects/volume/colours.h. COLOURS: accumulation takes them as they are.
uniform vec4 u_colour_low;       // what leaves these in any channel is dropped
uniform vec4 u_colour_high;
uniform vec2 u_colour_opacity;   // opacity of opacity 1 in a reference length, and 1 / that length [1/mm]
uniform vec2 u_colour_contrast;  // brightness and contrast

vec4 sample_colour(vec3 place) {
#if defined(FILTER_NEAREST)
    return texel(inside_volume(ivec3(floor(place * vec3(volume_size())))));
#elif defined(FILTER_LINEAR_FP32)
    Cell cell = cell_at(place);
    ivec3 low = inside_volume(ivec3(cell.low));
    ivec3 high = inside_volume(ivec3(cell.low) + 1);
    vec4 a = mix(texel(low), texel(ivec3(high.x, low.yz)), cell.a.x);
    vec4 b = mix(texel(ivec3(low.x, high.y, low.z)), texel(ivec3(high.xy, low.z)), cell.a.x);
    vec4 c = mix(texel(ivec3(low.xy, high.z)), texel(ivec3(high.x, low.y, high.z)), cell.a.x);
    vec4 d = mix(texel(ivec3(low.x, high.yz)), texel(high), cell.a.x);
    return mix(mix(a, b, cell.a.y), mix(c, d, cell.a.y), cell.a.z);
#else
    return linear_texel(place);
#endif
}

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
    vec4 c = sample_colour(place);
    bool kept = all(greaterThanEqual(c, u_colour_low)) && all(lessThanEqual(c, u_colour_high));
    float depth = depth_of_opacity(clamp(c.a * u_colour_opacity.x, 0.0, 1.0));
    vec3 colour = clamp((c.rgb + u_colour_contrast.x) * u_colour_contrast.y, 0.0, 1.0);
    return vec4(colour, kept ? depth * u_colour_opacity.y : 0.0);
}

// The ray caster itself with each sample counted.
#include "volume/sample.glsl"
int samples_taken = 0;
float counted_sample(vec3 place) {
    ++samples_taken;
    return sample_volume(place);
}
#ifdef COLOURS
vec4 counted_colour(vec3 place) {
    ++samples_taken;
    return sample_colour(place);
}
#define sample_colour counted_colour
#endif
#define sample_volume counted_sample
#include "volume/ray_cast_body.glsl"

vec4 count_ray(vec2 pixel) {
    vec4 colour = cast_ray(pixel);
    return vec4(float(samples_taken), colour.rgb);
}

// The transfer function's second axis: a factor on the opacity by gradient magnitude.
uniform sampler2D u_gradient_factor;  // one row
uniform vec3 u_gradient_place;        // texel value per mm -> entry; reference length [mm] and its reciprocal

float with_gradient_opacity(float extinction, float magnitude) {
    float last = float(textureSize(u_gradient_factor, 0).x - 1);
    float place = min(magnitude * u_gradient_place.x, last);
    int entry = int(place);
    float low = texelFetch(u_gradient_factor, ivec2(entry, 0), 0).r;
    float high = texelFetch(u_gradient_factor, ivec2(min(entry + 1, int(last)), 0), 0).r;
    // The factor is on the opacity of the reference length, not on the extinction.
    float opacity = mix(low, high, place - float(entry)) * (1.0 - exp(-extinction * u_gradient_place.y));
    return -log(max(1.0 - opacity, 5.9604645e-8)) * u_gradient_place.z;
}

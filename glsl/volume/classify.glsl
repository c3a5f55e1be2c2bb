// Colour and extinction over the volume's value: effects/volume/classification.h.
uniform sampler2D u_transfer;   // (r, g, b, extinction [1/mm]) by value, one row
uniform vec2 u_transfer_place;  // texel value -> entry: x * value + y

vec4 classify(float value) {
    float last = float(textureSize(u_transfer, 0).x - 1);
    float place = clamp(value * u_transfer_place.x + u_transfer_place.y, 0.0, last);
#ifdef TRANSFER_LINEAR
    int entry = int(place);
    vec4 low = texelFetch(u_transfer, ivec2(entry, 0), 0);
    vec4 high = texelFetch(u_transfer, ivec2(min(entry + 1, int(last)), 0), 0);
    return mix(low, high, place - float(entry));
#else
    return texelFetch(u_transfer, ivec2(int(place + 0.5), 0), 0);
#endif
}

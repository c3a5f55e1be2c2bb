// Colour and extinction over the volume's value: effects/volume/classification.h.
uniform samplerBuffer u_transfer;  // (r, g, b, extinction [1/mm]) by value
uniform vec3 u_transfer_place;  // texel value -> entry: x * value + y, from 0 to z
#ifdef HARDWARE
uniform float u_transfer_seen;  // below it, entries show nothing
#endif

vec4 classify(float value) {
    float place = clamp(value * u_transfer_place.x + u_transfer_place.y, 0.0, u_transfer_place.z);
#ifdef HARDWARE
    // Four floats take the texture unit as long as a look into the volume, and most places of most volumes show nothing.
    if (place < u_transfer_seen) {
        return vec4(0.0);
    }
#endif
#ifdef TRANSFER_LINEAR
    int entry = int(place);
    vec4 low = texelFetch(u_transfer, entry);
    vec4 high = texelFetch(u_transfer, min(entry + 1, int(u_transfer_place.z)));
    return mix(low, high, place - float(entry));
#else
    return texelFetch(u_transfer, int(place + 0.5));
#endif
}

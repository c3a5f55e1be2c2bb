/// A texel of a texture of one level, which must be bound with the nearest filter; beyond the border that of the border. Sampled rather than
/// fetched: llvmpipe asks for the level in each lane of a texelFetch, which takes it more than twice as many instructions.
vec4 texel_at(sampler2D image, ivec2 at) {
    return textureLod(image, (vec2(at) + 0.5) * (1.0 / vec2(textureSize(image, 0))), 0.0);
}

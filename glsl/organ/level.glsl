// Level among a picture's smaller copies whose texels are as large as a pixel's longer side on it. Below 0: the picture itself.
float level_of(sampler2D picture, vec2 uv) {
    vec2 texels = vec2(textureSize(picture, 0));
    vec2 x = texels * dFdx(uv);
    vec2 y = texels * dFdy(uv);
    return 0.5 * log2(max(max(dot(x, x), dot(y, y)), 1e-12));
}
